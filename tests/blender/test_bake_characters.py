"""Every rigged file that is there: each bake shows what its live meshes show."""

from __future__ import annotations

import importlib
from pathlib import Path

import bpy
import numpy as np
import pytest
from measure import positions
from tube import select

from blend_fixtures import CHARACTERS

REPOSITORY = Path(__file__).resolve().parents[2]
RIGGED = REPOSITORY.parent / "shared" / "data" / "rigged"
WRITTEN = [path for path in sorted((REPOSITORY / ".fixtures").glob("*.blend")) if path.stem in CHARACTERS]
FILES = [*WRITTEN, *(sorted(RIGGED.iterdir()) if RIGGED.is_dir() else [])]
FRAME_COUNT = 6
EXACT_TOLERANCE, REDUCED_TOLERANCE = 1e-6, 5e-3


def _open(path: Path) -> np.ndarray:
    """Frames of its animation."""
    if path.suffix == ".glb":
        bpy.ops.import_scene.gltf(filepath=str(path))
    elif path.suffix == ".fbx":
        bpy.ops.import_scene.fbx(filepath=str(path))
    else:
        bpy.ops.wm.open_mainfile(filepath=str(path))
    scene = bpy.context.scene
    ranges = [action.frame_range for action in bpy.data.actions] or [(scene.frame_start, scene.frame_end)]
    last = max(max(stop for _, stop in ranges), 2.0)
    return 1.0 + max((last - 1.0) // (FRAME_COUNT - 1), 1.0) * np.arange(FRAME_COUNT)


def _characters() -> list[bpy.types.Object]:
    """Meshes that Turgor Volume was put on."""
    found = []
    for ob in list(bpy.context.scene.objects):
        if ob.type != "MESH" or not any(modifier.type == "ARMATURE" for modifier in ob.modifiers):
            continue
        select([ob])
        if ob.turgor.version == 0:
            if not bpy.ops.object.turgor_volume_add.poll():
                continue
            bpy.ops.object.turgor_volume_add()
        if ob.turgor.version > 0:
            found.append(ob)
    return found


@pytest.mark.skipif(not FILES, reason="no fixtures written: run `make test`")
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_bakes_of_the_file_show_its_live_meshes(runtime, tmp_path, path):
    job, options = importlib.import_module("addon.bake.job"), importlib.import_module("addon.bake.options")
    frames = _open(path)
    characters = [ob for ob in _characters() if runtime.session.characters[ob.session_uid].binding is not None]
    assert characters
    for ob in characters:
        live = {frame: _at(ob, frame) for frame in frames}
        for method in ("ABSOLUTE", "CORRECTIVE", "POINT_CACHE", "REDUCED"):
            chosen = options.Options(
                method, frames, folder=tmp_path, name="Baked", tolerance=REDUCED_TOLERANCE, tolerance_is_relative=True
            )
            made = job.Job(ob, chosen)
            assert list(made.run())
            limit = made.report.size * (REDUCED_TOLERANCE if method == "REDUCED" else EXACT_TOLERANCE)
            for frame in frames:
                distances = np.linalg.norm(_at(made.baked, frame) - live[frame], axis=1)
                if method == "CORRECTIVE" and made.report.clamped_count:
                    limit = max(limit, made.report.max_error)
                assert distances.max() <= limit, (ob.name, method, frame)
            bpy.data.objects.remove(made.baked)


def _at(ob: bpy.types.Object, frame: float) -> np.ndarray:
    bpy.context.scene.frame_set(int(frame))
    return positions(ob).astype(np.float64)
