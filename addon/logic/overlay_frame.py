"""What overlays show of one frame of a character, worked out where it is looked at and not before."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np
import turgor
from numpy.typing import NDArray

from . import color_maps, strain
from .rest_geometry import RestGeometry

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


class OverlayFrame:
    """One frame of a character. Immutable but for what it remembers; for the main thread."""

    def __init__(
        self,
        engine: turgor.VolumeSkin,
        rest: RestGeometry,
        joint_rows: Mapping[str, Sequence[int]],
        pose_matrices: NDArray[np.float32],
        options: Mapping[str, Any],
        strength: float,
    ) -> None:
        """joint_rows: by name of the joint, its rows in the skeleton; of a bend several.

        pose_matrices, options: as for `VolumeSkin.deform`. strength: of the modifier, 0 where it is off.
        """
        self.rest = rest
        self._rows = joint_rows
        self._fields: dict[int, turgor.JointField | None] = {}
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
        fields = [self._field(row) for row in self._rows.get(joint, ())] if kind == "WEIGHT" else []
        gammas = [field.gamma for field in fields if field is not None]
        if kind == "DISPLACEMENT":
            values = np.linalg.norm(self._strength * self._frame.offsets.astype(np.float64) @ world[:3, :3].T, axis=1)
        elif kind == "STRAIN":
            values = self.strain
        elif gammas:
            values = np.max(gammas, axis=0).astype(np.float64)
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
        rest = self.rest
        return strain.strain(
            rest.fans, self._rest_positions, rest.apexes, self.positions.astype(np.float64), self._posed_apexes
        )

    @property
    def _rest_positions(self) -> NDArray[np.float64]:
        """(N, 3) the body of the frame, with its shape keys."""
        if (body := self._options.get("rest_positions")) is not None:
            return np.asarray(body, np.float64)
        rest = self.rest.positions.astype(np.float64)
        values = self._options.get("shape_values")
        if values is None or not np.any(values):
            return rest
        still = np.broadcast_to(np.eye(4), self._pose_matrices.shape)
        return self._engine.deform(np.ascontiguousarray(still), shape_values=values).skinned

    @property
    def _posed_apexes(self) -> NDArray[np.float64]:
        maps = self._object_maps()
        bones = self.rest.vertex_bones
        if not len(maps):
            return np.full_like(self.rest.apexes, np.nan)
        return np.einsum("nij,nj->ni", maps[bones, :3, :3], self.rest.apexes) + maps[bones, :3, 3]

    def _object_maps(self) -> NDArray[np.float64]:
        """(B, 4, 4) from rest to pose of each bone, object space."""
        armature_from_object = np.linalg.inv(self.rest.object_from_armature)
        return self._object_from_armature @ self._pose_matrices @ armature_from_object

    @property
    def _object_from_armature(self) -> NDArray[np.float64]:
        return np.asarray(self._options["object_from_armature"], np.float64)

    def joint_field(self, joint: str) -> turgor.JointField | None:
        """The frame and weights of a joint, of a bend at its middle; None where there is none."""
        row = self._middle(joint)
        return None if row is None else self._field(row)

    def _field(self, row: int) -> turgor.JointField | None:
        if row not in self._fields:
            has_joint = row in self._engine.joint_bones
            # Fields are made before folds are looked for.
            options = {name: value for name, value in self._options.items() if name != "repair_folds"}
            self._fields[row] = self._engine.joint_field(row, self._pose_matrices, **options) if has_joint else None
        return self._fields[row]

    def joint_origin(self, joint: str) -> NDArray[np.float64] | None:
        """(3,) where the joint is in the pose, of a bend its middle, object space; None without such a joint."""
        row = self._middle(joint)
        if row is None:
            return None
        place = self._object_from_armature @ self._pose_matrices[row]
        return place[:3, :3] @ self.rest.heads[row] + place[:3, 3]

    def _middle(self, joint: str) -> int | None:
        rows = self._rows.get(joint, ())
        return rows[len(rows) // 2] if rows else None


def _quantile(values: NDArray[np.float64], part: float) -> float:
    finite = values[np.isfinite(values)]
    return float(np.quantile(finite, part)) if len(finite) else 0.0
