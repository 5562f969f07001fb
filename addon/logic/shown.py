"""What overlays show of one frame of a character, worked out where it is looked at and not before."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np
import turgor
from numpy.typing import NDArray

from . import color_maps, strain

Heat = Literal["DISPLACEMENT", "WEIGHT", "STRAIN"]

# With an automatic range of strain this part of the vertices is hotter than the hottest color, for thin cones shout;
# and it ends where nothing is left.
BEYOND_RANGE, MOST_STRAIN = 0.02, 1.0


class Colors(NamedTuple):
    """A heat map."""

    colors: NDArray[np.float32]  # (N, 4) sRGB and alpha
    color_map: NDArray[np.float32]  # (K, 3) of the legend, from the lowest value to the highest
    lowest: float
    highest: float


class Anatomy(NamedTuple):
    """What of a binding only overlays look at. N vertices, B bones; object space, armature space where said."""

    rest_positions: NDArray[np.float32]  # (N, 3)
    face_offsets: NDArray[np.int32]  # (F + 1,)
    face_corners: NDArray[np.int32]  # (C,)
    weight_offsets: NDArray[np.int32]  # (N + 1,)
    weight_bones: NDArray[np.int32]  # (W,)
    weights: NDArray[np.float32]  # (W,)
    parents: NDArray[np.int32]  # (B,)
    heads: NDArray[np.float64]  # (B, 3) armature space
    tails: NDArray[np.float64]  # (B, 3) armature space
    object_from_armature: NDArray[np.float64]  # (4, 4) at rest


class Flesh:
    """Derived from the anatomy when first looked at, then kept with the binding."""

    def __init__(self, anatomy: Anatomy) -> None:
        self.anatomy = anatomy

    @cached_property
    def triangles(self) -> NDArray[np.int32]:
        """(T, 3) fans of all faces."""
        offsets, corners = self.anatomy.face_offsets, self.anatomy.face_corners
        counts = np.maximum(np.diff(offsets) - 2, 0)
        first = np.repeat(offsets[:-1], counts)
        within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        return np.stack([corners[first], corners[first + within + 1], corners[first + within + 2]], axis=1)

    @cached_property
    def edge_length(self) -> float:
        """Median at rest."""
        ends = self.anatomy.rest_positions[self.triangles[:, :2]]
        return float(np.median(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1))) if len(ends) else 0.0

    @cached_property
    def fans(self) -> strain.Fans:
        """Of the mesh."""
        known = self.anatomy
        return strain.Fans(len(known.rest_positions), known.face_offsets, known.face_corners)

    @cached_property
    def vertex_bones(self) -> NDArray[np.int32]:
        """(N,) the bone with the largest weight, -1 without any."""
        known = self.anatomy
        count = len(known.rest_positions)
        vertices = np.repeat(np.arange(count), np.diff(known.weight_offsets))
        order = np.lexsort((-known.weights, vertices))
        is_first = np.ones(len(order), bool)
        is_first[1:] = np.diff(vertices[order]) > 0
        found = np.full(count, -1, np.int32)
        found[vertices[order][is_first]] = known.weight_bones[order][is_first]
        return found

    @cached_property
    def rest_apexes(self) -> NDArray[np.float64]:
        """(N, 3) of the cones of strain, object space."""
        known = self.anatomy
        place = known.object_from_armature
        heads, tails = (ends @ place[:3, :3].T + place[:3, 3] for ends in (known.heads, known.tails))
        return strain.closest_on_bones(
            known.rest_positions.astype(np.float64), self.vertex_bones, known.parents, heads, tails
        )


class Shown:
    """One frame. Immutable but for what it remembers; for the main thread."""

    def __init__(
        self,
        engine: turgor.VolumeSkin,
        flesh: Flesh,
        bone_names: Sequence[str],
        pose_matrices: NDArray[np.float32],
        options: Mapping[str, Any],
        strength: float,
    ) -> None:
        """pose_matrices, options: as for `VolumeSkin.deform`. strength: of the modifier, 0 where it is off."""
        self.flesh = flesh
        self._bones = {name: index for index, name in enumerate(bone_names)}
        self._fields: dict[str, turgor.JointField | None] = {}
        self._engine, self._pose_matrices, self._options, self._strength = engine, pose_matrices, options, strength

    @cached_property
    def _frame(self) -> turgor.Frame:
        return self._engine.deform(self._pose_matrices, **self._options)

    @cached_property
    def positions(self) -> NDArray[np.float32]:
        """(N, 3) as the modifier leaves them, object space."""
        if self._strength == 1.0:
            return self._frame.positions.astype(np.float32)
        return (self._frame.skinned + self._strength * self._frame.offsets).astype(np.float32)

    def heat(self, kind: Heat, joint: str, world: NDArray[np.float64], most: float, opacity: float) -> Colors | None:
        """None where there is nothing to color.

        joint: whose weight is shown. world: (4, 4) world_from_object, for lengths. most: the hottest value, 0: found.
        """
        field = self.joint_field(joint) if kind == "WEIGHT" else None
        if kind == "DISPLACEMENT":
            values = np.linalg.norm(self._strength * self._frame.offsets.astype(np.float64) @ world[:3, :3].T, axis=1)
        elif kind == "STRAIN":
            values = self.strain
        elif field is not None:
            values = field.gamma.astype(np.float64)
        else:
            return None
        is_signed = kind == "STRAIN"
        most = most or (min(_quantile(np.abs(values), 1.0 - BEYOND_RANGE), MOST_STRAIN) if is_signed else values.max())
        colors = color_maps.colors_of(values, most, is_signed=is_signed, opacity=opacity)
        color_map = color_maps.signed() if is_signed else color_maps.magnitude()
        return Colors(colors, color_map, -most if is_signed else 0.0, most)

    @cached_property
    def strain(self) -> NDArray[np.float64]:
        """(N,) of the mesh as the modifier leaves it, see `logic.strain`."""
        flesh = self.flesh
        return strain.strain(
            flesh.fans, self._rest_positions, flesh.rest_apexes, self.positions.astype(np.float64), self._posed_apexes
        )

    @property
    def _rest_positions(self) -> NDArray[np.float64]:
        """(N, 3) with the frame's shape keys."""
        rest = self.flesh.anatomy.rest_positions.astype(np.float64)
        values = self._options.get("shape_values")
        if values is None or not np.any(values):
            return rest
        still = np.broadcast_to(np.eye(4), self._pose_matrices.shape)
        return self._engine.deform(np.ascontiguousarray(still), shape_values=values).skinned

    @property
    def _posed_apexes(self) -> NDArray[np.float64]:
        maps = self._object_maps()
        bones = self.flesh.vertex_bones
        rest = self.flesh.rest_apexes
        return np.einsum("nij,nj->ni", maps[bones, :3, :3], rest) + maps[bones, :3, 3]

    def _object_maps(self) -> NDArray[np.float64]:
        """(B, 4, 4) from rest to pose of each bone, object space."""
        armature_from_object = np.linalg.inv(self.flesh.anatomy.object_from_armature)
        return self._object_from_armature @ self._pose_matrices @ armature_from_object

    @property
    def _object_from_armature(self) -> NDArray[np.float64]:
        return np.asarray(self._options["object_from_armature"], np.float64)

    def joint_field(self, joint: str) -> turgor.JointField | None:
        """Of the joint at the head of this bone; None where it has none."""
        if joint not in self._fields:
            bone = self._bones.get(joint, -1)
            has_joint = bone in self._engine.joint_bones
            # Fields are made before folds are looked for.
            options = {name: value for name, value in self._options.items() if name != "repair_folds"}
            self._fields[joint] = self._engine.joint_field(bone, self._pose_matrices, **options) if has_joint else None
        return self._fields[joint]

    def joint_origin(self, joint: str) -> NDArray[np.float64] | None:
        """(3,) where the joint is in the pose, object space; None where there is no such bone."""
        bone = self._bones.get(joint)
        if bone is None:
            return None
        place = self._object_from_armature @ self._pose_matrices[bone]
        return place[:3, :3] @ self.flesh.anatomy.heads[bone] + place[:3, 3]


def _quantile(values: NDArray[np.float64], part: float) -> float:
    known = values[np.isfinite(values)]
    return float(np.quantile(known, part)) if len(known) else 0.0
