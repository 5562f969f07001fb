"""The compiled engine. Arrays are numpy; see each call for shape, dtype, space and errors."""

from collections.abc import Sequence
from typing import Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

Shares = tuple[float, float, float] | Literal["auto"]

class TurgorError(ValueError):
    """What was found, what is needed, what to do."""

@final
class Mesh:
    """A surface at rest: corners welded by position, shells found, openings closed by virtual caps.

    rest_positions: (N, 3) float32 or float64, object space.
    face_offsets: (F + 1,) int32, face f has corners face_corners[face_offsets[f]:face_offsets[f + 1]].
    face_corners: (C,) int32, vertex of each corner, counter-clockwise seen from outside.
    weld_tolerance: corners of open edges closer than this, relative to the diagonal, are one point.

    Raises TurgorError for non-finite positions, indices out of range, faces with fewer than three corners.
    A mesh without vertices or faces is accepted: it has no component.
    """

    def __new__(
        cls,
        rest_positions: ArrayLike,
        face_offsets: ArrayLike,
        face_corners: ArrayLike,
        weld_tolerance: float = 1e-6,
    ) -> Mesh: ...
    @property
    def vertex_count(self) -> int: ...
    @property
    def welded_count(self) -> int:
        """Distinct points after welding."""
    @property
    def components(self) -> list[Component]: ...
    @property
    def vertex_components(self) -> NDArray[np.int32]:
        """(N,) index into `components`, -1 for a loose vertex."""
    @property
    def rest_positions(self) -> NDArray[np.float64]: ...
    def volume(self, positions: ArrayLike) -> float:
        """Enclosed volume of all sound components, signed, cubic units of `positions` (MATH 1)."""
    def component_volumes(self, positions: ArrayLike) -> NDArray[np.float64]:
        """(K,) signed volume per component; 0 for one that is not sound."""
    def volume_gradient(self, positions: ArrayLike) -> NDArray[np.float64]:
        """(N, 3) derivative of `volume` by each vertex; twins of one point share its gradient."""

@final
class Component:
    """One connected shell of a mesh."""

    @property
    def status(self) -> Literal["closed", "capped", "sheet", "flat", "non_manifold", "not_orientable"]:
        """closed and capped (openings closed by virtual fans) are corrected, the others stay as skinned.

        sheet: so open that its caps would be most of its surface (a cape); flat: encloses nothing.
        """
    @property
    def is_sound(self) -> bool:
        """True when the component is corrected."""
    @property
    def rest_volume(self) -> float:
        """Signed: negative when the faces look inwards. Cubic units of object space."""
    @property
    def vertex_count(self) -> int: ...
    @property
    def face_count(self) -> int: ...
    @property
    def boundary_edge_count(self) -> int: ...
    @property
    def flipped_face_count(self) -> int:
        """Faces whose winding was turned to agree with the majority."""

@final
class Skeleton:
    """Bones at rest.

    parents: (B,) int32, index of the parent bone or -1; any order, no cycles.
    rest_matrices: (B, 4, 4), armature space; only heads (translations) steer the correction.
    """

    def __new__(cls, parents: ArrayLike, rest_matrices: ArrayLike) -> Skeleton: ...
    @property
    def bone_count(self) -> int: ...

@final
class Skinning:
    """Blend skinning that reproduces Blender's Armature modifier.

    Influences of vertex v: weight_bones / weights[weight_offsets[v]:weight_offsets[v + 1]], in the order in which
    Blender stores the vertex groups (it matters for dual quaternions). Only deform bones; weights need no
    normalisation; a vertex whose sum is at most 1e-4 stays where it is.

    mode: "linear" or "dual_quaternion" (Blender's *Preserve Volume*).
    vertex_mask: (N,) influence of the whole modifier per vertex (its vertex group, already inverted if so set).
    """

    def __new__(
        cls,
        skeleton: Skeleton,
        weight_offsets: ArrayLike,
        weight_bones: ArrayLike,
        weights: ArrayLike,
        mode: Literal["linear", "dual_quaternion"] = "linear",
        vertex_mask: ArrayLike | None = None,
    ) -> Skinning: ...
    @property
    def vertex_count(self) -> int: ...
    def deform(
        self,
        positions: ArrayLike,
        pose_matrices: ArrayLike,
        object_from_armature: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """(N, 3) skinned positions, object space.

        positions: (N, 3) object space, before the Armature modifier.
        pose_matrices: (B, 4, 4) per bone pose @ inverse(rest), armature space (Blender's `matrix_channel`), row major.
        object_from_armature: (4, 4), inverse(object.matrix_world) @ armature.matrix_world; identity if None.
        """

@final
class Joint:
    """How the volume lost at the joint at the head of `bone` is given back.

    shares: parts along the joint's axes e0 (along the parent), e1 (axis of the bend), e2 (inside of the bend), or
        "auto", which None stands for: the least displacement.
    profiles: three 1D curves over x in [-1, 1] of the joint's length, each a sequence of at least 2 samples at even
        spacing, zero outside; samples below 0 count as 0. None: the isotropic bell.
    folded_profile: second curve for axis 0, reached as the loss approaches `folded_loss_relative` of the volume of the
        joint's vicinity, a tenth of its length cubed (Belly); None: no change with loss.
    strength: part of the loss given back, >= 0. size: factor on the joint's automatic length, > 0.
    """

    def __new__(
        cls,
        bone: int,
        shares: Shares | None = None,
        profiles: tuple[ArrayLike, ArrayLike, ArrayLike] | None = None,
        *,
        folded_profile: ArrayLike | None = None,
        folded_loss_relative: float = 0.1,
        strength: float = 1.0,
        size: float = 1.0,
    ) -> Joint: ...
    @property
    def bone(self) -> int: ...
    @property
    def strength(self) -> float: ...
    @property
    def size(self) -> float: ...
    @property
    def shares(self) -> Shares: ...

@final
class VolumeSkin:
    """A bound character: skins and restores the volume. Immutable; safe to call from several threads.

    joints: settings of joints; bones not named use the isotropic preset. None: all isotropic. A joint handed in with
        strength 0 gives nothing back.
    solver: "simultaneous" (order-free, default) or "sequential" (as in the paper, parents first).
    keep_bone_scale: bone scale and translation move the target volume (intent, not loss). False: the target is the rest
        volume whatever the bones do.
    object_from_armature: (4, 4) as it stands at bind; turns lengths of the mesh into the skeleton's. Identity if None.
    shape_deltas: (K, N, 3) displacement of each shape key from rest_positions, mixed by `shape_values` each frame.
    """

    def __new__(
        cls,
        mesh: Mesh,
        skinning: Skinning,
        joints: Sequence[Joint] | None = None,
        *,
        solver: Literal["simultaneous", "sequential"] = "simultaneous",
        keep_bone_scale: bool = True,
        shape_deltas: ArrayLike | None = None,
        object_from_armature: ArrayLike | None = None,
    ) -> VolumeSkin: ...
    @property
    def mesh(self) -> Mesh: ...
    @property
    def joint_bones(self) -> NDArray[np.int32]:
        """(J,) bones that have a joint, in the order of every per-joint array of `Report`: parents first."""
    @property
    def joint_lengths(self) -> NDArray[np.float64]:
        """(J,) automatic length times size, armature space: the unit of the profiles."""
    @property
    def memory_bytes(self) -> int:
        """Bound data plus one workspace."""
    def with_joints(
        self,
        joints: Sequence[Joint] | None,
        *,
        solver: Literal["simultaneous", "sequential"] | None = None,
        keep_bone_scale: bool | None = None,
    ) -> VolumeSkin:
        """The same binding with other settings; cheap, the mesh and weights are shared."""
    def deform(
        self,
        pose_matrices: ArrayLike,
        *,
        object_from_armature: ArrayLike | None = None,
        shape_values: ArrayLike | None = None,
        strengths: ArrayLike | None = None,
        target_scale: float = 1.0,
    ) -> Frame:
        """Skin and correct one frame. Arguments as in `Skinning.deform`.

        strengths: (B,) strength of the joint of each bone in place of its setting (keyed strengths).
        target_scale: factor on the target volume (breathing). Raises TurgorError for a pose that is not finite, wrong
        shapes, or an object matrix without inverse. Releases the GIL.
        """
    def deform_into(
        self,
        offsets: NDArray[np.float32],
        pose_matrices: ArrayLike,
        *,
        object_from_armature: ArrayLike | None = None,
        shape_values: ArrayLike | None = None,
        strengths: ArrayLike | None = None,
        target_scale: float = 1.0,
    ) -> Report:
        """As `deform`, writing corrected - skinned into `offsets`, (N, 3) float32 C-contiguous; allocates no array."""
    def deform_into_address(
        self,
        offsets_address: int,
        vertex_count: int,
        pose_matrices: ArrayLike,
        *,
        object_from_armature: ArrayLike | None = None,
        shape_values: ArrayLike | None = None,
        strengths: ArrayLike | None = None,
        target_scale: float = 1.0,
    ) -> Report:
        """As `deform_into`, at a raw address of vertex_count * 3 floats that the caller keeps alive."""

@final
class Frame:
    """Result of one frame, object space."""

    @property
    def positions(self) -> NDArray[np.float64]:
        """(N, 3) corrected."""
    @property
    def skinned(self) -> NDArray[np.float64]:
        """(N, 3) before the correction."""
    @property
    def offsets(self) -> NDArray[np.float32]:
        """(N, 3) corrected - skinned."""
    @property
    def report(self) -> Report: ...

@final
class Report:
    """Figures of one frame. Volumes are signed like the component, cubic units of object space."""

    @property
    def skinned_volumes(self) -> NDArray[np.float64]:
        """(K,) per component, 0 where not sound."""
    @property
    def target_volumes(self) -> NDArray[np.float64]:
        """(K,)"""
    @property
    def corrected_volumes(self) -> NDArray[np.float64]:
        """(K,) measured on the corrected f64 positions."""
    @property
    def joint_losses(self) -> NDArray[np.float64]:
        """(J,) volume each joint's rotation took, all components, positive = lost."""
    @property
    def joint_regained(self) -> NDArray[np.float64]:
        """(J,) volume given back by each joint's own field, to first order."""
    @property
    def joint_displacements(self) -> NDArray[np.float64]:
        """(J,) bound on the largest displacement by each joint's field, armature space."""
    @property
    def joint_is_capped(self) -> NDArray[np.bool_]:
        """(J,) the profile was too narrow: part of the volume went to a wider field."""
    @property
    def seam_gap(self) -> float:
        """Largest distance between skinned twins of one welded point, object space."""
    @property
    def max_displacement(self) -> float:
        """Largest |corrected - skinned|, object space."""
    @property
    def relative_error(self) -> float:
        """Largest |corrected - target| / |target| over sound components."""

def correct(
    mesh: Mesh,
    positions: ArrayLike,
    target_volume: float | ArrayLike,
    gamma: ArrayLike,
    frame: ArrayLike | None = None,
    shares: Shares = "auto",
) -> NDArray[np.float64]:
    """The bare formula of MATH 2: (N, 3) positions whose volume is the target, exact in one step per axis.

    target_volume: one number (single component, or the sum over components spread by what each can take) or (K,).
    gamma: (N,) >= 0, 0 fixes a vertex; used as given (divide by area for an even swelling).
    frame: (3, 3) rows e0, e1, e2, need not be orthogonal; None: frame-free, along the volume gradient.
    Raises TurgorError where gamma leaves a component with a volume to add nothing to move.
    """
