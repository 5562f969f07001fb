"""Files of other formats read again, beside what was live: in an empty file, so only where nothing is open for long."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import bpy
import numpy as np
from mathutils.kdtree import KDTree
from numpy.typing import NDArray

from . import rest

# Between two processes.
_ASKED, _ARRAYS, ANSWER = "asked.json", "shapes.npz", "answer.json"
# Float32 of files, and of several matrices in a chain.
FLOOR_PERCENT = 0.01


class Shape(NamedTuple):
    """One frame."""

    frame: int
    points: NDArray[np.float64]  # (N, 3) world space
    volume: float  # of triangles, as they lie at rest


class Live(NamedTuple):
    """An object before it was written."""

    names: frozenset[str]  # its own and that of its mesh: importers take one or the other
    shapes: Sequence[Shape]


class Difference(NamedTuple):
    """How far an imported file is from the live meshes, at most over all frames."""

    max_error_relative: float  # of any vertex to the nearest, part of the size
    volume_error_relative: float


class ImportedError(ValueError):
    """The file does not hold what was written."""


def live(ob: bpy.types.Object, frames: Sequence[int]) -> Live:
    """Names and evaluated shapes of a live object at these frames."""
    return Live(frozenset((ob.name, ob.data.name)), shapes(ob, frames))


def shapes(ob: bpy.types.Object, frames: Sequence[int]) -> list[Shape]:
    """Evaluated shapes of an object at these frames.

    Triangles are those of the original mesh where it has the same faces.
    """
    scene, found = bpy.context.scene, []
    corners: NDArray[np.int32] | None = None
    for frame in frames:
        scene.frame_set(frame)
        evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
        own = ob.data if len(ob.data.loops) == len(evaluated.data.loops) else evaluated.data
        if corners is None:
            corners = _triangles(own)
        points = _world(evaluated)
        found.append(Shape(frame, points, _volume(points, corners)))
    return found


def compare(path: Path, kind: str, written: Mapping[str, Live]) -> dict[str, Difference]:
    """By name of the object. What is open is closed. Raises ImportedError."""
    rate = bpy.context.scene.render.fps, bpy.context.scene.render.fps_base
    bpy.ops.wm.read_homefile(use_empty=True)
    # Some formats keep times in seconds.
    bpy.context.scene.render.fps, bpy.context.scene.render.fps_base = rate
    try:
        if kind == "GLTF":
            bpy.ops.import_scene.gltf(filepath=str(path))
        elif kind == "FBX":
            bpy.ops.import_scene.fbx(filepath=str(path), anim_offset=0.0)
        elif kind == "USD":
            bpy.ops.wm.usd_import(filepath=str(path), set_frame_range=False)
        else:
            bpy.ops.wm.alembic_import(filepath=str(path), set_frame_range=False)
    except RuntimeError as error:
        raise ImportedError(f"{path.name} cannot be imported again: {str(error).strip()}") from error
    matched = _matched(written, path)
    return {name: _difference(matched[name], each.shapes) for name, each in written.items()}


def ask(folder: Path, path: Path, kind: str, written: Mapping[str, Live]) -> None:
    """Leaves in `folder` all that `answer` needs, in another process."""
    render = bpy.context.scene.render
    rows = {
        f"{number} {shape.frame}": np.append(shape.points.ravel(), shape.volume)
        for number, live in enumerate(written.values())
        for shape in live.shapes
    }
    np.savez(folder / _ARRAYS, **rows)
    asked = {
        "path": str(path),
        "kind": kind,
        "rate": [render.fps, render.fps_base],
        "objects": {name: sorted(live.names) for name, live in written.items()},
    }
    (folder / _ASKED).write_text(json.dumps(asked))


def answer(folder: str) -> None:
    """Leaves in `folder` what `compare` finds, or the text of its error."""
    asked = json.loads((Path(folder) / _ASKED).read_text())
    written = {}
    with np.load(Path(folder) / _ARRAYS) as arrays:
        for number, (name, names) in enumerate(asked["objects"].items()):
            rows = {int(key.split()[1]): arrays[key] for key in arrays.files if int(key.split()[0]) == number}
            shapes = [Shape(frame, row[:-1].reshape(-1, 3), float(row[-1])) for frame, row in sorted(rows.items())]
            written[name] = Live(frozenset(names), shapes)
    bpy.context.scene.render.fps, bpy.context.scene.render.fps_base = asked["rate"]
    try:
        found: object = compare(Path(asked["path"]), asked["kind"], written)
    except ImportedError as error:
        found = str(error)
    (Path(folder) / ANSWER).write_text(json.dumps(found))


def _matched(written: Mapping[str, Live], path: Path) -> dict[str, bpy.types.Object]:
    """Which imported mesh is which object: by its name where it has it still, else by what formats make of names.

    No mesh is two objects. Raises ImportedError.
    """
    left = [ob for ob in bpy.data.objects if ob.type == "MESH"]
    found: dict[str, bpy.types.Object] = {}
    for is_it in (_has_name, _has_a_name, _has_plain_name):
        for name, live in written.items():
            match = next((ob for ob in left if is_it(ob.name, name, live.names)), None)
            if name not in found and match is not None:
                found[name] = match
                left.remove(match)
    missing = [" or ".join(sorted(live.names)) for name, live in written.items() if name not in found]
    if missing:
        raise ImportedError(f"{path.name} has no mesh {', '.join(missing)}")
    return found


def _has_name(imported: str, name: str, _names: frozenset[str]) -> bool:
    return imported == name


def _has_a_name(imported: str, _name: str, names: frozenset[str]) -> bool:
    return imported in names


def _has_plain_name(imported: str, _name: str, names: frozenset[str]) -> bool:
    """Without spaces and full stops, or with a number of Blender's own."""
    plain = names | {name.replace(" ", "_").replace(".", "_") for name in names}
    return imported in plain or imported.rpartition(".")[0] in plain


def _difference(ob: bpy.types.Object, expected: Sequence[Shape]) -> Difference:
    size = float(np.linalg.norm(np.ptp(expected[0].points, axis=0))) or 1.0
    distance = volume = 0.0
    for found, wanted in zip(shapes(ob, [each.frame for each in expected]), expected, strict=True):
        distance = max(distance, _farthest(found.points, wanted.points), _farthest(wanted.points, found.points))
        if wanted.volume:
            volume = max(volume, abs(found.volume / wanted.volume - 1.0))
    return Difference(distance / size, volume)


def _farthest(points: NDArray[np.float64], others: NDArray[np.float64]) -> float:
    """Largest distance from a point to the nearest of the others: files reorder vertices and split them at seams."""
    tree = KDTree(len(others))
    for place, other in enumerate(others):
        tree.insert(other, place)
    tree.balance()
    return max((tree.find(point)[2] for point in points), default=0.0)


def _world(evaluated: bpy.types.Object) -> NDArray[np.float64]:
    matrix = np.array(evaluated.matrix_world, np.float64)
    return rest.read_positions(evaluated.data).astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]


def _triangles(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    mesh.calc_loop_triangles()
    corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    return corners.reshape(-1, 3)


def _volume(points: NDArray[np.float64], triangles: NDArray[np.int32]) -> float:
    """Enclosed, about the centroid."""
    a, b, c = (points - points.mean(axis=0))[triangles].transpose(1, 0, 2)
    return abs(float(np.einsum("ij,ij->", a, np.cross(b, c)))) / 6.0
