"""Corrective shape keys: before an Armature, so that it and the keys together show the live mesh."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..live import joint_names
from ..logic import inverse_skinning, joint_regions, local_reduction, reduction
from ..scene import baked_copy, plain_rig, shape_key_writing
from .baking import Baking, Progress
from .computing import POSITION_BYTES
from .options import BakeError
from .shape_key_frames import own_modifiers, tent
from .skinned_rest import PosedSkin, skin_of

# Of the tolerance, for the numbers of keys and of Blender's own skinning, which are float32.
ROUNDING_RELATIVE = 5e-7


class Deltas:
    """What keys must add before the Armature, frame by frame."""

    def __init__(self, baking: Baking) -> None:
        source, options = baking.source, baking.options
        self.skin = skin_of(
            baking.target,
            source.end,
            source.rest,
            source.placement,
            source.bound_frame,
            influences=options.influences,
            use_linear=options.use_linear,
        )
        self._baking = baking
        self.growth = np.zeros(baking.report.vertex_count)
        self.chunks: list[NDArray[np.float32]] = []

    def compute(self) -> Iterator[Progress]:
        """Fills `chunks`, (S, N, 3)."""
        baking, done, count = self._baking, 0, len(self._baking.poses)
        for positions in baking.chunks:
            rows = np.empty(positions.shape, np.float32)
            for row, wanted in zip(rows, positions, strict=True):
                posed = baking.poses[done]
                if posed is None:
                    raise BakeError("Corrective keys stand before an Armature, there is none")
                maps = self.skin.maps(posed)
                found = inverse_skinning.inverse(maps, shaped(baking, posed.shape_values), wanted)
                row[...] = found.deltas
                self.growth = np.maximum(self.growth, inverse_skinning.growth(maps))
                baking.report.clamped_count += int(found.is_clamped.sum())
                done += 1
            self.chunks.append(rows)
            yield baking.making(0.6 * done / count, f"Correctives of {done} of {count} frames")


def shaped(baking: Baking, values: NDArray[np.float32]) -> NDArray[np.float64]:
    """(N, 3) at rest, with the artist's own keys."""
    read = baking.source.rest
    positions = read.positions.astype(np.float64)
    if len(values) and values.any():
        positions += np.tensordot(values.astype(np.float64), read.shape_deltas.astype(np.float64), 1)
    return positions


def per_frame(baking: Baking) -> Iterator[Progress]:
    """One key per frame."""
    deltas = Deltas(baking)
    yield from deltas.compute()
    make_copy(baking, deltas.skin)
    frames, columns, number = baking.options.frames, own_columns(baking), 0
    for chunk in deltas.chunks:
        for row in chunk:
            columns[add(baking, f"Frame {frames[number]:g}", row, 0.0, 1.0)] = tent(frames, number)
            number += 1
        yield baking.making(0.6 + 0.4 * number / len(frames), f"{number} of {len(frames)} keys")
    finish(baking, len(frames), columns)


def reduced(baking: Baking) -> Iterator[Progress]:
    """Make corrective keys, as few as keep the tolerance on every frame."""
    deltas = Deltas(baking)
    yield from deltas.compute()
    yield baking.making(0.6, "Looking for the fewest keys")
    options = baking.options
    least = 2.0 * ROUNDING_RELATIVE * baking.size
    if options.tolerance < least:
        raise BakeError(f"The error asked for is below what numbers in Blender hold: give at least {least:.1e}")
    tolerance = options.tolerance - 0.5 * least
    if options.local_keys:
        made = yield from _by_joint(baking, deltas, tolerance)
    else:
        made = _whole(baking, deltas, tolerance)
    make_copy(baking, deltas.skin)
    columns = own_columns(baking)
    for number, (name, key, values) in enumerate(made):
        low = 0.0 if values.min() >= 0.0 else -1.0
        columns[add(baking, name, key, low, 1.0)] = (options.frames, values)
        yield baking.making(0.8 + 0.2 * number / len(made), f"{number + 1} of {len(made)} keys")
    finish(baking, len(made), columns)


class Made(NamedTuple):
    """A key and its value on each frame."""

    name: str
    key: NDArray[np.float32]  # (N, 3)
    values: NDArray[np.float64]  # (F,)


def _whole(baking: Baking, deltas: Deltas, tolerance: float) -> list[Made]:
    """Keys of the whole mesh."""
    found = reduction.reduce(deltas.chunks, tolerance, deltas.growth)
    if baking.options.unit_values:
        found = reduction.within_unit(found)
    pairs = zip(found.keys, found.values.T, strict=True)
    return [Made(f"Turgor {number + 1}", *pair) for number, pair in enumerate(pairs)]


def _by_joint(baking: Baking, deltas: Deltas, tolerance: float) -> Generator[Progress, None, list[Made]]:
    """Keys of the skin around one joint each, named after the bone at whose head it is."""
    bones, rest, first = deltas.skin.bones, baking.source.rest.positions, baking.poses[0]
    assert first is not None
    place = first.object_from_armature
    heads = bones.rest_matrices[:, :3, 3] @ place[:3, :3].T + place[:3, 3]
    around = joint_regions.regions(rest, deltas.skin.weights, bones.parents, heads)
    made: list[Made] = []
    parts = local_reduction.reduce(deltas.chunks, around, tolerance, deltas.growth)
    for number, found in enumerate(parts):
        shown = local_reduction.within_unit(found) if baking.options.unit_values else found
        row = found.region.bone
        name = baking.target.name if row < 0 else joint_names.of_region(bones, row)
        for rank, (part, values) in enumerate(zip(shown.keys, shown.values.T, strict=True)):
            key = np.zeros_like(rest)
            key[found.region.vertices] = part
            made.append(Made(f"{name} {rank + 1}", key, values))
        yield baking.making(0.6 + 0.2 * number / len(around), f"Keys of {number + 1} of {len(around)} joints")
    return made


def make_copy(baking: Baking, skin: PosedSkin) -> None:
    """Make the copy that gets the keys, with the Armature that they were made for and the artist's own keys."""
    source, options = baking.source, baking.options
    baking.copy = copy = baked_copy.make(
        baking.target, source.end, source.bound_frame, own_modifiers(baking, keep_armature=True), options.name
    )
    armature = copy.modifiers[source.end.name]
    baking.last = armature.name
    if options.use_linear:
        armature.use_deform_preserve_volume = False
    if skin.is_other:
        own = source.end.object
        armature.object = plain_rig.make(own)
        if copy.parent == own:
            # Exporters skin what hangs on its armature.
            copy.parent = armature.object
        armature.use_bone_envelopes, armature.use_vertex_groups = False, True
    if options.influences or skin.is_other:
        names = [name for name, is_deform in zip(skin.bones.names, skin.bones.is_deform, strict=True) if is_deform]
        places = np.cumsum(skin.bones.is_deform) - 1
        weights = skin.weights
        shape_key_writing.set_groups(copy, names, weights.offsets, places[weights.bones], weights.weights)
    keys = baking.target.data.shape_keys
    for key, delta in zip(keys.key_blocks[1:] if keys is not None else (), source.rest.shape_deltas, strict=True):
        own = shape_key_writing.add_key(copy, key.name, source.rest.positions + delta, key.slider_min, key.slider_max)
        copy.data.shape_keys.key_blocks[own].value = key.value


def own_columns(baking: Baking) -> dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Keyframes of the artist's own keys, as they were sampled."""
    keys = baking.target.data.shape_keys
    if keys is None:
        return {}
    values = np.array([posed.shape_values for posed in baking.poses if posed is not None], np.float64)
    names = [key.name for key in keys.key_blocks[1:]]
    return {name: (baking.options.frames, column) for name, column in zip(names, values.T, strict=True)}


def add(baking: Baking, name: str, delta: NDArray[np.floating], low: float, high: float) -> str:
    """A key of the copy that adds `delta`, (N, 3)."""
    return shape_key_writing.add_key(baking.copy, name, baking.source.rest.positions + delta, low, high)


def finish(baking: Baking, key_count: int, columns: dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]) -> None:
    """Keyframes, and figures of the report."""
    keys = baking.copy.data.shape_keys if baking.copy is not None else None
    if keys is not None and columns:
        shape_key_writing.key_values(keys, columns)
    baking.report.key_count = key_count
    stored = 0 if keys is None else len(keys.key_blocks)
    baking.report.byte_count = stored * baking.report.vertex_count * POSITION_BYTES
