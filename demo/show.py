"""The whole demonstration of one file, in order."""

from __future__ import annotations

import os
from contextlib import ExitStack
from pathlib import Path

import bpy
import numpy as np
import turgor

from . import live, playing, timing
from .characters import armature_of, open_file, skinned_meshes
from .evaluated import armature_modifier, modifier_after, only_modifiers_before
from .outline import draw_outline
from .page import PicturePair, page
from .pictures import AFTER_TONE, BEFORE_TONE, Studio, View, joint_view, whole_view
from .report import ObjectReport, Report
from .subject import Subject
from .takes import Take, takes

Meshes = list[bpy.types.Object]


def show(file: Path, output: Path) -> None:
    """Plays, measures, times and pictures every skinned mesh of a file; writes report.json and index.html."""
    open_file(file)
    meshes = skinned_meshes()
    if not meshes:
        raise SystemExit(f"{file}: found no visible mesh with an Armature modifier, need at least one")
    armatures = list(dict.fromkeys(armature_of(mesh_object) for mesh_object in meshes))
    all_takes = takes(armatures)

    subjects = play_without(meshes, armatures, all_takes)
    play_with(subjects, all_takes)
    for subject in subjects:
        if subject.problem is None:
            with timing.alone(subject.mesh_object, meshes):
                subject.armature_times = timing.armature_times(subject.mesh_object, all_takes)
                subject.live_times = timing.live_times(subject.mesh_object, all_takes)

    frames = [(take.name, frame) for take in all_takes for frame in take.frames]
    objects = [subject.report(file.name, frames) for subject in subjects]
    hero = hero_of(subjects, objects)
    output.mkdir(parents=True, exist_ok=True)
    pairs = take_pictures(subjects[hero], objects[hero], meshes, all_takes, output) if hero is not None else []
    report = Report(bpy.app.version_string, turgor.__version__, os.cpu_count() or 1, objects)
    report.write(output / "report.json")
    written = page(report, None if hero is None else objects[hero], pairs)
    (output / "index.html").write_text(written, encoding="utf-8")
    for item in objects:
        before, after = item.max_relative_volume_error_before, item.max_relative_volume_error_after
        verdict = f"off by {before:.2g} without, {after:.2g} with Turgor" if item.is_corrected else item.problem
        print(f"{item.object}: {verdict}")
    print(f"Look at {output / 'index.html'}")


def play_without(meshes: Meshes, armatures: Meshes, all_takes: list[Take]) -> list[Subject]:
    """Measures with the Armature as the last modifier."""
    with ExitStack() as stack:
        for mesh_object in meshes:
            end = modifier_after(mesh_object, armature_modifier(mesh_object))
            stack.enter_context(only_modifiers_before(mesh_object, end))
        tracks = playing.at_rest(meshes, armatures)
        playing.play(tracks, all_takes)
        return [Subject(track, np.array(track.volumes)) for track in tracks]


def play_with(subjects: list[Subject], all_takes: list[Take]) -> None:
    """Turns Turgor on and measures with it as the last modifier."""
    for subject in subjects:
        subject.problem = live.turn_on(subject.mesh_object)
    corrected = [subject for subject in subjects if subject.problem is None]
    with ExitStack() as stack:
        for subject in corrected:
            end = modifier_after(subject.mesh_object, live.volume_modifier(subject.mesh_object))
            stack.enter_context(only_modifiers_before(subject.mesh_object, end))

        def note_frame() -> None:
            for subject in corrected:
                subject.note_frame()

        playing.play([subject.track for subject in corrected], all_takes, note_frame)
    for subject in corrected:
        subject.after = np.array(subject.track.volumes)


def hero_of(subjects: list[Subject], objects: list[ObjectReport]) -> int | None:
    """Index of the mesh that loses most in the world: the one to look at."""

    def loss(index: int) -> float:
        volumes = subjects[index].volumes()
        if volumes is None or not objects[index].is_corrected:
            return -1.0
        off = np.abs(volumes.before - volumes.target)[:, volumes.is_corrected].sum(axis=1).max()
        return float(off) * abs(subjects[index].mesh_object.matrix_world.determinant())

    best = max(range(len(subjects)), key=loss)
    return best if loss(best) >= 0.0 else None


def take_pictures(
    subject: Subject, item: ObjectReport, meshes: Meshes, all_takes: list[Take], output: Path
) -> list[PicturePair]:
    """The hero's worst frame: the whole character, and the joint that lost most, without and with Turgor."""
    take = next(take for take in all_takes if take.name == item.worst_take)
    take.begin()
    bpy.context.scene.frame_set(item.worst_frame)
    whole = whole_view(meshes)
    bone, joint = worst_joint(subject.mesh_object, whole)
    when = f"{item.worst_take}, frame {item.worst_frame}"
    views = [
        ("whole", "The worst frame", f"{when}: here the Armature alone is furthest off.", whole),
        ("joint", f"The joint that lost most: {bone}", f"{when}.", joint),
    ]
    studio = Studio(meshes)
    pairs = [
        PicturePair(title, text, output / f"{name}_before.png", output / f"{name}_after.png")
        for name, title, text, _ in views
    ]
    volume_modifiers = [modifier for mesh_object in meshes if (modifier := live.volume_modifier(mesh_object))]
    for is_on in (False, True):
        for modifier in volume_modifiers:
            modifier.show_render = modifier.show_viewport = is_on
        for pair, (*_, view) in zip(pairs, views, strict=True):
            path, tone = (pair.after, AFTER_TONE) if is_on else (pair.before, BEFORE_TONE)
            studio.take_picture(view, tone, path)
    for pair in pairs:
        draw_outline(pair.before, pair.after)
    return pairs


def worst_joint(mesh_object: bpy.types.Object, whole: View) -> tuple[str, View]:
    """Name of the bone whose joint lost most in the current frame, and a view of it."""
    number, length = live.live_frame(mesh_object).worst_joint()
    name = live.bone_name(mesh_object, number)
    armature = armature_of(mesh_object)
    world = armature.matrix_world
    bone = armature.pose.bones[name]
    parent_direction = bone.head - bone.parent.head if bone.parent else bone.vector
    bend_axis = (world.to_3x3() @ parent_direction.cross(bone.vector)).normalized()
    return name, joint_view(whole, world @ bone.head, bend_axis, 0.6 * length * world.median_scale)
