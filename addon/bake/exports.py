"""Exports through Blender's own exporters that keep the volume.

Alembic and USD hold every frame of the mesh as it is evaluated. glTF and FBX hold an armature that moves the mesh, and
shape keys before it: they get a copy with corrective keys made for the skinning that engines do, linear and with few
influences, and without any other modifier, with which exporters drop the keys.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import bpy

from .. import runtime
from ..logic import frame_range
from ..logic.bake_report import BakeReport
from ..messages import message
from ..scene import baked_copy, export_selection, plain_rig, spine_stack, stack
from .job import Job
from .options import BakeError, Options

SUFFIXES = {"GLTF": ".glb", "FBX": ".fbx", "USD": ".usdc", "ALEMBIC": ".abc"}
WITH_KEYS = frozenset({"GLTF", "FBX"})


@dataclass(frozen=True)
class Settings:
    """What one export writes; settings of keys count only for formats with keys."""

    format: str  # of SUFFIXES
    path: Path
    error_relative: float = 1e-4  # largest of reduced keys, part of the size; 0: one key per frame
    influences: int = 4  # bones per vertex
    local_keys: bool = False  # reduced keys that move the skin around one joint each


def export(targets: Sequence[bpy.types.Object], settings: Settings) -> list[BakeReport]:
    """All frames of the scene: a report for each character where keys were made.

    The scene is as it was before, whether it ends well or not. Raises BakeError and what `Job.run` raises.
    """
    if not targets:
        raise BakeError("No selected object has Turgor Volume or Turgor Spine: select a character")
    with ExitStack() as kept:
        if settings.format not in WITH_KEYS:
            kept.enter_context(export_selection.only(targets))
            _write(settings)
            return []
        jobs = [kept.enter_context(_with_keys(target, settings)) for target in targets]
        copies = [job.baked for job in jobs]
        rigs = [modifier.object for copy in copies for modifier in copy.modifiers if modifier.type == "ARMATURE"]
        kept.enter_context(export_selection.only([*copies, *rigs]))
        _write(settings)
        return [job.report for job in jobs]


@contextmanager
def _with_keys(target: bpy.types.Object, settings: Settings) -> Iterator[Job]:
    """A copy under the name of the character, for as long as it is exported."""
    scene, name, mesh_name = bpy.context.scene, target.name, target.data.name
    is_reduced = settings.error_relative > 0.0
    options = Options(
        method="REDUCED" if is_reduced else "CORRECTIVE",
        frames=frame_range.steps(scene.frame_start, scene.frame_end, 1.0),
        tolerance=settings.error_relative,
        tolerance_is_relative=True,
        # Engines clamp values.
        unit_values=True,
        local_keys=settings.local_keys,
        influences=settings.influences,
        use_linear=True,
        name=f"{name} Export",
    )
    job = Job(target, options)
    with runtime.quiet():
        for _ in job.run():
            pass
    copy = job.baked
    armature = stack.armature_modifier(target)
    rig = None if armature is None else armature.object
    rigs = [] if rig is None else [(rig, double, rig.name) for double in plain_rig.doubles_of(copy)]
    try:
        for modifier in [modifier for modifier in copy.modifiers if modifier.type != "ARMATURE"]:
            job.report.notes.append(
                message("{modifier} is not in the file: with it shape keys would be lost", modifier=modifier.name)
            )
            copy.modifiers.remove(modifier)
        for own, other, kept in ((target, copy, name), (target.data, copy.data, mesh_name), *rigs):
            if own.library is None:
                own.name = f"{kept} Live"
                other.name = kept
        yield job
    finally:
        owns = [(target, name), (target.data, mesh_name), *((rig, kept) for rig, _, kept in rigs)]
        baked_copy.discard(copy)
        for own, kept in owns:
            if own.library is None:
                own.name = kept


def has_turgor(ob: bpy.types.Object) -> bool:
    """Whether there is something to keep."""
    return ob.type == "MESH" and (stack.volume_modifier(ob) is not None or spine_stack.spine_modifier(ob) is not None)


def _write(settings: Settings) -> None:
    scene, path = bpy.context.scene, str(settings.path)
    if settings.path.is_dir():
        raise BakeError(message("{file} is a folder: choose another name", file=settings.path.name))
    before = _written(settings.path)
    try:
        if settings.format == "GLTF":
            bpy.ops.export_scene.gltf(
                filepath=path,
                export_format="GLTF_SEPARATE" if settings.path.suffix == ".gltf" else "GLB",
                use_selection=True,
                export_apply=False,
                export_skins=True,
                export_influence_nb=max(settings.influences, 1),
                export_all_influences=settings.influences == 0,
                export_morph=True,
                export_morph_animation=True,
                export_morph_normal=True,
                export_animations=True,
                export_animation_mode="SCENE",
                export_anim_scene_split_object=False,
                export_frame_range=True,
                # Keys that are 0 all the time count too.
                export_optimize_animation_size=False,
            )
        elif settings.format == "FBX":
            bpy.ops.export_scene.fbx(
                filepath=path,
                use_selection=True,
                object_types={"ARMATURE", "MESH"},
                add_leaf_bones=False,
                bake_anim=True,
                bake_anim_use_all_actions=False,
                bake_anim_use_nla_strips=False,
                bake_anim_simplify_factor=0.0,
            )
        elif settings.format == "USD":
            bpy.ops.wm.usd_export(
                filepath=path,
                selected_objects_only=True,
                export_animation=True,
                export_armatures=False,
                export_shapekeys=False,
                evaluation_mode="VIEWPORT",
            )
        else:
            bpy.ops.wm.alembic_export(
                filepath=path,
                selected=True,
                start=scene.frame_start,
                end=scene.frame_end,
                evaluation_mode="VIEWPORT",
            )
    except RuntimeError as error:
        raise BakeError(
            message("{file} was not written: {reason}", file=settings.path.name, reason=_reason(error))
        ) from error
    # Some exporters only log what went wrong.
    if _written(settings.path) == before:
        raise BakeError(message("{file} was not written: look at the console for the reason", file=settings.path.name))


def _written(path: Path) -> dict[str, int]:
    """When files of this name were last written, in nanoseconds; exporters choose the ending by themselves."""
    if not path.parent.is_dir():
        return {}
    files = [each for each in path.parent.iterdir() if each.stem == path.stem and each.is_file()]
    return {each.name: each.stat().st_mtime_ns for each in files}


def _reason(error: RuntimeError) -> str:
    """What an exporter told; of its traceback the line that says what happened."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip() and not line.startswith("Location:")]
    return lines[-1 if "Traceback" in str(error) else 0] if lines else repr(error)
