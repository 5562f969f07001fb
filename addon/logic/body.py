"""A bound character: the engine's binding, and the same binding under the settings of a frame."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
import turgor
from numpy.typing import NDArray

from . import shells
from .rest_geometry import RestGeometry
from .weights import BoneWeights

Solver = Literal["simultaneous", "sequential"]
Fields = Literal["plain", "even"]


def bind(
    positions: NDArray[np.float32],
    face_offsets: NDArray[np.int32],
    face_corners: NDArray[np.int32],
    parents: NDArray[np.int32],
    rest_matrices: NDArray[np.float64],
    tails: NDArray[np.float64],
    weights: BoneWeights,
    vertex_mask: NDArray[np.float32] | None,
    is_dual_quaternion: bool,
    shape_deltas: NDArray[np.float32],
    object_from_armature: NDArray[np.float64],
    is_segment: Sequence[bool] | None = None,
) -> Body:
    """Bind a mesh to its bones. Shapes as in the fields of `scene.rest.RestMesh` and `scene.skeleton.RestBones`.

    object_from_armature: (4, 4) at rest. Rigs come at other scales than their meshes, and joints have lengths.
    is_segment: (B,) of bones that are segments of the bone above.
    """
    skinning = turgor.Skinning(
        turgor.Skeleton(parents, rest_matrices, is_segment),
        *weights,
        mode="dual_quaternion" if is_dual_quaternion else "linear",
        vertex_mask=vertex_mask,
    )
    mesh = turgor.Mesh(positions, face_offsets, face_corners)
    deltas = shape_deltas if len(shape_deltas) else None
    engine = turgor.VolumeSkin(mesh, skinning, shape_deltas=deltas, object_from_armature=object_from_armature)
    faces, heads = (face_offsets, face_corners), rest_matrices[:, :3, 3]
    return Body(
        engine, skinning, RestGeometry(positions, *faces, *weights, parents, heads, tails, object_from_armature)
    )


class Body:
    """Keeps the engine of the last settings, swapped as a whole: safe to call from several threads."""

    def __init__(self, engine: turgor.VolumeSkin, skinning: turgor.Skinning, rest: RestGeometry) -> None:
        self.rest, self.skinning = rest, skinning
        self._unmasked = self._bound = engine
        self._mask: NDArray[np.float32] | None = None
        self._current: tuple[object, turgor.VolumeSkin, NDArray[np.float64]] = (None, engine, self._strengths(()))

    @property
    def joint_bones(self) -> list[int]:
        """Bones that have a joint, parents first: the order of the report."""
        return self._bound.joint_bones.tolist()

    @property
    def current_engine(self) -> turgor.VolumeSkin:
        """The engine under the settings of the last frame."""
        return self._current[1]

    @property
    def mesh(self) -> turgor.Mesh:
        """The mesh that was bound."""
        return self._bound.mesh

    @property
    def vertex_count(self) -> int:
        """Vertices of the stack after the Armature."""
        return self._bound.mesh.vertex_count

    @property
    def rest_volume(self) -> float:
        """Volume of all corrected components, each counted positive."""
        return sum(abs(part.rest_volume) for part in self._bound.mesh.components if part.is_sound)

    @property
    def shells(self) -> shells.Shells:
        """What its shells are like: closed, open, inside out; worked out anew on each access."""
        return shells.describe(self._bound.mesh)

    @property
    def mask(self) -> NDArray[np.float32] | None:
        """(N,) factor on how much each vertex moves."""
        return self._mask

    def masked(self, mask: NDArray[np.float32] | None) -> Body:
        """A body with this binding under another mask, and with the settings of the last frame."""
        made = Body(self._unmasked, self.skinning, self.rest)
        key, engine, strengths = self._current
        if mask is None:
            return made
        made._mask, made._bound = mask, self._unmasked.with_mask(mask)
        made._current = (key, engine.with_mask(mask), strengths)
        return made

    @property
    def pinned_shells(self) -> int:
        """Shells that would be corrected, had the mask left any of their vertices free."""
        mesh, mask = self._bound.mesh, self._mask
        if mask is None:
            return 0
        free = np.zeros(len(mesh.components), bool)
        free[np.unique(mesh.vertex_components[(mask > 0.0) & (mesh.vertex_components >= 0)])] = True
        return sum(part.is_sound and not is_free for part, is_free in zip(mesh.components, free, strict=True))

    def with_settings(
        self,
        key: object,
        joints: Callable[[], Sequence[turgor.Joint]],
        solver: Solver,
        fields: Fields,
        keep_bone_scale: bool,
    ) -> tuple[turgor.VolumeSkin, NDArray[np.float64]]:
        """The engine for these settings, and (J,) strengths in the order of `joint_bones`.

        key: changes whenever any of the settings does.
        """
        current = self._current
        if current[0] != key:
            chosen = joints()
            engine = self._bound.with_joints(chosen, solver=solver, fields=fields, keep_bone_scale=keep_bone_scale)
            self._current = current = (key, engine, self._strengths(chosen))
        return current[1:]

    def _strengths(self, joints: Sequence[turgor.Joint]) -> NDArray[np.float64]:
        of_bone = {joint.bone: joint.strength for joint in joints}
        return np.array([of_bone.get(bone, 1.0) for bone in self.joint_bones], np.float64)
