"""The compiled engine. Arrays are numpy; see each call for shape, dtype, space and errors.

Arrays that are read may have any layout and byte order: what is not C-contiguous, aligned and of the dtype is copied.
Coordinates, lengths and elements of matrices may be up to 1e15 in size: TurgorError names what is not. All results are
finite.
"""

from collections.abc import Callable, Sequence
from typing import Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

Shares = tuple[float, float, float] | tuple[float, float, float, float] | Literal["auto"]
Kind = Literal["radial", "normal", "binormal"]
Match = Literal["stations", "relative_length", "length"]

class TurgorError(ValueError):
    """What was found, what is needed, what to do."""

class FaultError(TurgorError):
    """A fault of the engine itself, where and why; there is no result. Please report it."""

class CancelledError(Exception):
    """A progress callback returned False: nothing was changed."""

def _fault(message: str) -> None:
    """Panics in the engine: for tests of what becomes of a fault. Raises FaultError."""

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
        """(N, 3) derivative of `volume` by each vertex; coincident vertices share the gradient of their point."""

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
    segments: (B,) whether a bone is a segment of its parent, as those of a bendy bone: all of them are one
    bone group. Where segments stand to each other is how their group bends, and no more meant than a turn.
    """

    def __new__(
        cls, parents: ArrayLike, rest_matrices: ArrayLike, segments: Sequence[bool] | None = None
    ) -> Skeleton: ...
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

    shares: parts along the joint's axes e0 (along the parent), e1 (axis of the bend), e2 (inside of the bend); a fourth
        number is the part that goes by the least displacement. "auto", which None stands for, is (0, 0, 0, 1), three
        numbers are four with a 0. Only their ratios count.
    profiles: three 1D curves over x in [-1, 1] of the joint's length, each a sequence of at least 2 samples at even
        spacing, zero outside; samples below 0 count as 0, none is above 1e6. None: the isotropic bell.
    folded_profiles: three curves that the profiles turn into as the loss approaches `folded_loss_relative` of the
        volume of the joint's vicinity (Belly): a tenth of its length cubed, an eightieth where fields are even; None:
        no change with loss.
    strength: part of the loss given back, 0 to 1e9. size: factor on the joint's automatic length, 1e-6 to 1e6.
    flex: how far the joint's shape bulges beyond what was lost, as a muscle that is tensed, 0 to 10: 1 is a tenth of
        the volume of the joint's vicinity. It is taken from all of the vicinity: the body's
        volume stays.
    flesh: how far skin follows the law of flesh before volume is looked at (MATH 10), 0: none, the same bits as
        without it; 1: all. Offsets hold what it adds, `Frame.skinned` does not. It acts where the joint has another
        above it, and fades out over the last 30 degrees before a bend or twist of 180, where a bone is flattened or
        mirrored, and where a joint of a cut chain goes with another bone than it hangs on. Segments, and bones that are
        `fleshed` in a frame, are left alone; a mask holds the law back as it does corrections.
    outside: 1: soft flesh on the outside of a bend; 0: bone under the skin; None: by how near the joint lies to it.
    spread_twist: 1: twists are spread straight along the bone as far as the next joint; 0: they lie where weights
        blend. A bone that leads to no other joint, or is no longer than thick, always does the latter.
    crease: 1: the inside of a bend closes on the plane that halves it; 0: it is left as it comes. Only where the bone
        above runs on into this one.
    These four are 0 to 1.
    """

    def __new__(
        cls,
        bone: int,
        shares: Shares | None = None,
        profiles: tuple[ArrayLike, ArrayLike, ArrayLike] | None = None,
        *,
        folded_profiles: tuple[ArrayLike, ArrayLike, ArrayLike] | None = None,
        folded_loss_relative: float = 0.1,
        strength: float = 1.0,
        size: float = 1.0,
        flex: float = 0.0,
        flesh: float = 0.0,
        outside: float | None = None,
        spread_twist: float = 1.0,
        crease: float = 1.0,
    ) -> Joint: ...
    @property
    def bone(self) -> int: ...
    @property
    def strength(self) -> float: ...
    @property
    def size(self) -> float: ...
    @property
    def flex(self) -> float: ...
    @property
    def flesh(self) -> float: ...
    @property
    def outside(self) -> float | None: ...
    @property
    def spread_twist(self) -> float: ...
    @property
    def crease(self) -> float: ...
    @property
    def shares(self) -> Shares: ...

@final
class JointField:
    """How one joint's field lies in one pose, object space: for those who draw it."""

    @property
    def origin(self) -> NDArray[np.float64]:
        """(3,) the joint."""
    @property
    def axes(self) -> NDArray[np.float64]:
        """(3, 3) rows e0 along the parent, e1 axis of the bend, e2 inside of the bend.

        The place x of the profiles is origin + length * (x @ axes): unit vectors where the object is scaled evenly.
        """
    @property
    def axes_share(self) -> float:
        """w of MATH 3: part of the volume that follows the axes; 0 for a straight pose, where e1 and e2 are any."""
    @property
    def length(self) -> float:
        """Unit of the profiles, in this pose."""
    @property
    def gamma(self) -> NDArray[np.float32]:
        """(N,) weight of each vertex in the field, before areas: 0 outside the joint's vicinity.

        axes_share of it is the profiles', the rest the bell's, and all of it where there are no profiles; times what
        the mask leaves.
        """

@final
class VolumeSkin:
    """A bound character: skins and restores the volume. Immutable; safe to call from several threads.

    joints: settings of joints; bones not named use the isotropic preset. None: all isotropic. A joint handed in with
        strength 0 gives nothing back.
    solver: "simultaneous" (order-free, default) or "sequential" (as in the paper, parents first).
    keep_bone_scale: bone scale and translation move the target volume (intent, not loss). False: the target is the rest
        volume whatever the bones do.
    fields: "plain": along the gradient of the volume, as in the paper, and less of a profile the farther from its
        joint; "even": along normals that are evened out over a part of the flesh below, so that fine detail is carried
        along, and profiles act as they are drawn. With added offsets or positions
        of another deformer, along the gradient too.
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
        fields: Literal["plain", "even"] = "plain",
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
        fields: Literal["plain", "even"] | None = None,
    ) -> VolumeSkin:
        """The same binding and mask with other settings; cheap, the mesh and weights are shared."""
    def with_mask(self, mask: ArrayLike | None) -> VolumeSkin:
        """The same binding and settings with another mask; very cheap, all else is shared.

        mask: (N,) float32 in 0..1, factor on the vertex's weight in every field; None: no mask. Only factors against
        each other count, per component: one number everywhere is no mask. Coincident vertices share the smallest of
        theirs. A vertex of 0 comes out exactly as skinned. The volume stays exact; a component of nothing but 0 stays
        as skinned, see `Report.component_is_pinned`. Where a mask leaves next to nothing of a joint's vicinity, the
        joint's volume goes to the whole shell, and the joint is reported as capped.
        """
    def deform(
        self,
        pose_matrices: ArrayLike,
        *,
        object_from_armature: ArrayLike | None = None,
        shape_values: ArrayLike | None = None,
        rest_positions: ArrayLike | None = None,
        strengths: ArrayLike | None = None,
        target_scale: float = 1.0,
        added_offsets: ArrayLike | None = None,
        posed_positions: ArrayLike | None = None,
        fleshed: Sequence[bool] | None = None,
        repair_folds: bool = False,
    ) -> Frame:
        """Skin and correct one frame. Arguments as in `Skinning.deform`.

        rest_positions: (N, 3) float32, object space: the body of this frame, in place of the bound rest positions with
        shape keys mixed in; shape_values are not looked at. Skin, losses and volumes at rest are its own; topology,
        weights, and which skin a joint moves by how much, stay as bound.
        strengths: (B,) strength of the joint of each bone in place of its setting (keyed strengths).
        target_scale: factor on the target volume (breathing), above 0, up to 1e9.
        added_offsets: (N, 3) float32, object space: what another deformer adds to the skin before its volume is looked
        at; `Frame.skinned` has it. The volume that it takes is given back where it was lost (MATH 9): by joints in
        whose vicinity that is, the rest by the skin itself. fleshed: (B,) bones whose flesh that deformer moves, exact
        in place: what skinning loses at their joints is not missing.

        repair_folds: a *fold* is a pair of triangles that pass through each other when corrected, and did not when
        skinned; quads are cut from their first corner to the third, larger faces by their ears. Vertices of folds back
        off along their displacement until there is none, and stand there while the volume comes back elsewhere. The
        exact volume goes before folds: where both cannot be had, the result is the exact one with the fewest folds,
        and `Report.folds_left` counts them. Without folds the result is the same to the last bit.

        Raises TurgorError for a pose that is not finite, wrong
        shapes, or an object matrix without inverse. Releases the GIL.
        """
    def deform_into(
        self,
        offsets: NDArray[np.float32],
        pose_matrices: ArrayLike,
        *,
        object_from_armature: ArrayLike | None = None,
        shape_values: ArrayLike | None = None,
        rest_positions: ArrayLike | None = None,
        strengths: ArrayLike | None = None,
        target_scale: float = 1.0,
        added_offsets: ArrayLike | None = None,
        posed_positions: ArrayLike | None = None,
        fleshed: Sequence[bool] | None = None,
        repair_folds: bool = False,
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
        rest_positions: ArrayLike | None = None,
        strengths: ArrayLike | None = None,
        target_scale: float = 1.0,
        added_offsets: ArrayLike | None = None,
        posed_positions: ArrayLike | None = None,
        fleshed: Sequence[bool] | None = None,
        repair_folds: bool = False,
    ) -> Report:
        """As `deform_into`, at a raw address of vertex_count * 3 floats that the caller keeps alive."""
    def joint_field(
        self,
        bone: int,
        pose_matrices: ArrayLike,
        *,
        object_from_armature: ArrayLike | None = None,
        shape_values: ArrayLike | None = None,
        rest_positions: ArrayLike | None = None,
        strengths: ArrayLike | None = None,
        target_scale: float = 1.0,
        added_offsets: ArrayLike | None = None,
        posed_positions: ArrayLike | None = None,
        fleshed: Sequence[bool] | None = None,
    ) -> JointField:
        """How the field of the joint at the head of `bone` lies in this pose. Arguments as in `deform`.

        Raises TurgorError also for a bone without a joint, one not in `joint_bones`. Releases the GIL.
        """
    def measure(
        self,
        pose_matrices: ArrayLike,
        *,
        object_from_armature: ArrayLike | None = None,
        shape_values: ArrayLike | None = None,
        rest_positions: ArrayLike | None = None,
        strengths: ArrayLike | None = None,
        target_scale: float | ArrayLike = 1.0,
        added_offsets: ArrayLike | None = None,
        posed_positions: ArrayLike | None = None,
        fleshed: Sequence[bool] | None = None,
    ) -> Measures:
        """Figures of many poses, many at once: the same bits as `deform` gives one by one.

        pose_matrices: (F, B, 4, 4). fleshed: as in `deform`, the same for all frames. The others as in `deform`, the
        same for all frames or with a first axis of F: rest_positions, added_offsets and posed_positions (N, 3) or
        (F, N, 3).
        Raises TurgorError as `deform`, for the first frame that is refused. Releases the GIL.
        """
    def deform_many(
        self,
        pose_matrices: ArrayLike,
        *,
        object_from_armature: ArrayLike | None = None,
        shape_values: ArrayLike | None = None,
        rest_positions: ArrayLike | None = None,
        strengths: ArrayLike | None = None,
        target_scale: float | ArrayLike = 1.0,
        added_offsets: ArrayLike | None = None,
        posed_positions: ArrayLike | None = None,
        fleshed: Sequence[bool] | None = None,
        effect: float | ArrayLike = 1.0,
        repair_folds: bool = False,
        fold_counts: NDArray[np.int32] | None = None,
        positions: NDArray[np.float32] | None = None,
    ) -> NDArray[np.float32]:
        """(F, N, 3) positions of many poses, object space, many at once: the same bits as of one by one.

        effect: part of the way from skinned to corrected, one number or (F,). repair_folds: as in `deform`, at
        full effect. fold_counts: (F, 3) int32 C-contiguous, to be filled: folds found, folds left, vertices blocked.
        positions: float32 C-contiguous, to be filled and returned in place of a new array. The others as in `measure`:
        hand in so many frames at a time as memory allows.
        """

    def refinement_need(
        self,
        pose_matrices: ArrayLike,
        *,
        object_from_armature: ArrayLike | None = None,
        shape_values: ArrayLike | None = None,
        rest_positions: ArrayLike | None = None,
        strengths: ArrayLike | None = None,
        target_scale: float | ArrayLike = 1.0,
        added_offsets: ArrayLike | None = None,
        posed_positions: ArrayLike | None = None,
        fleshed: Sequence[bool] | None = None,
    ) -> RefinementNeed:
        """Where these poses together ask for more vertices than the mesh has; their order does not matter.

        Arguments as in `measure`.
        """

@final
class RefinementNeed:
    """Where joints give volume back, and how finely: the most of all poses (RHC09 4.3)."""

    @property
    def gamma(self) -> NDArray[np.float32]:
        """(N,) largest weight of any joint in any pose, 0..1.

        As in `JointField`, but for profiles of height 1 with the valleys between their highest places filled in: folds
        are found too where vertices are too far apart to see them. In proportion less for a joint that gives back less
        than 2 % of its vicinity's volume.
        """
    @property
    def edge_lengths(self) -> NDArray[np.float32]:
        """(N,) object space: edges so long follow the joints' profiles there to 5 % of their height, root mean square.

        What gamma makes less visible asks for less; infinite where gamma is 0.
        """

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
    def flesh_volumes(self) -> NDArray[np.float64]:
        """(K,) with what the law of flesh adds; as skinned without it."""
    @property
    def target_volumes(self) -> NDArray[np.float64]:
        """(K,)"""
    @property
    def corrected_volumes(self) -> NDArray[np.float64]:
        """(K,) as solved: the volume's cubic at the step that was taken, about 1e-12 from that of `positions`.

        To measure it apart from the solver: `Mesh.component_volumes(frame.positions)`.
        """
    @property
    def joint_losses(self) -> NDArray[np.float64]:
        """(J,) volume each joint's rotation took, all components, positive = lost.

        They sum to what `flesh_volumes` lack of the targets.
        """
    @property
    def joint_regained(self) -> NDArray[np.float64]:
        """(J,) volume given back by each joint's own field, to first order."""
    @property
    def joint_displacements(self) -> NDArray[np.float64]:
        """(J,) bound on the largest displacement by each joint's field, armature space."""
    @property
    def joint_is_capped(self) -> NDArray[np.bool_]:
        """(J,) the profile was too narrow, or masked: part of the volume went to a wider field."""
    @property
    def component_is_pinned(self) -> NDArray[np.bool_]:
        """(K,) the mask lets nothing of it move: it stays as skinned."""
    @property
    def seam_gap(self) -> float:
        """Largest distance between skinned vertices of one welded point, object space."""
    @property
    def max_displacement(self) -> float:
        """Largest |corrected - skinned|, object space."""
    @property
    def folds_found(self) -> int:
        """Folds of the correction before repair, see `VolumeSkin.deform`; 0 where they were not looked for."""
    @property
    def folds_left(self) -> int:
        """Folds after repair; 0 where it succeeded."""
    @property
    def blocked_vertices(self) -> NDArray[np.int32]:
        """(M,) vertices that backed off and were held, rising."""
    @property
    def relative_error(self) -> float:
        """Largest |corrected - target| / |target| over sound components that are not pinned."""

@final
class Measures:
    """Figures of F frames, as in `Report`: K components, J joints in the order of `joint_bones`."""

    @property
    def skinned_volumes(self) -> NDArray[np.float64]:
        """(F, K)"""
    @property
    def flesh_volumes(self) -> NDArray[np.float64]:
        """(F, K)"""
    @property
    def target_volumes(self) -> NDArray[np.float64]:
        """(F, K)"""
    @property
    def corrected_volumes(self) -> NDArray[np.float64]:
        """(F, K)"""
    @property
    def joint_losses(self) -> NDArray[np.float64]:
        """(F, J) positive = lost."""
    @property
    def joint_regained(self) -> NDArray[np.float64]:
        """(F, J)"""
    @property
    def joint_is_capped(self) -> NDArray[np.bool_]:
        """(F, J)"""
    @property
    def max_displacements(self) -> NDArray[np.float64]:
        """(F,) largest |corrected - skinned|, object space."""

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

@final
class Spine:
    """The open curve that drives fleshing: quintic pieces, four times differentiable, rigid beyond its ends (MATH 5).

    points: (n, 3) stations, object space; at least 2, no two neighbours at one place.
    method: "spline" passes through the points and is straight at its ends. "polynomial" [ZR13] is one through all
        points, "b_spline" [ZR13] is steered by them: these are bent at their ends, a run-out of an eighth of their
        length straightens them, and they are rigid beyond it.
    parameters: (n,) rising parameter of each point, "chord" (steps are distances; None too) or "centripetal" (roots of
        distances).
    normal: (3,) direction of the first axis of the frames at the first point; what is along the tangent is taken off.
        None: any, the same for the same points.

    Raises TurgorError for one point, coincident neighbours, points that are not finite, parameters that do not rise.
    """

    def __new__(
        cls,
        points: ArrayLike,
        method: Literal["spline", "polynomial", "b_spline"] = "spline",
        *,
        parameters: Literal["chord", "centripetal"] | ArrayLike | None = None,
        normal: ArrayLike | None = None,
    ) -> Spine: ...
    @staticmethod
    def from_bezier(
        points: ArrayLike,
        left_handles: ArrayLike,
        right_handles: ArrayLike,
        *,
        cyclic: bool = False,
        tolerance: float = 1e-3,
        resolution: int | None = None,
        normal: ArrayLike | None = None,
    ) -> Spine:
        """Blender's Bezier spline: (n, 3) control points and handles; each point is a station.

        Such curves have corners of curvature at which a body would crease: a smooth spline through samples of the curve
        stands for it. resolution: samples per segment, 1 to 64; None: the fewest that keep `deviation` below
        tolerance × length. Curves that move keep the resolution of their rest, or bodies jump between two frames.
        Raises TurgorError for cyclic curves and as `Spine`.
        """
    @staticmethod
    def from_nurbs(
        points: ArrayLike,
        weights: ArrayLike | None = None,
        *,
        order: int = 4,
        use_endpoint: bool = True,
        use_bezier: bool = False,
        cyclic: bool = False,
        tolerance: float = 1e-3,
        resolution: int | None = None,
        normal: ArrayLike | None = None,
    ) -> Spine:
        """Blender's NURBS spline: (n, 3) control points, (n,) weights; order and flags as Blender has them.

        Stations are the ends of its spans. Further arguments and errors as `from_bezier`.
        """
    @staticmethod
    def from_poly(
        points: ArrayLike,
        *,
        cyclic: bool = False,
        resolution: int = 1,
        normal: ArrayLike | None = None,
    ) -> Spine:
        """Blender's poly spline, (n, 3) points, its corners rounded: resolution 1 passes smoothly through the points.

        More samples per segment follow it closer and turn its corners sharper. Errors as `from_bezier`.
        """
    def posed(self, points: ArrayLike, *, normal: ArrayLike | None = None) -> Spine:
        """The spine of other points with this one's method and parameters, station by station: a pose of it.

        points: (n, 3), as many as this spine was made from. normal: as in `Spine`; None: this spine's, turned by the
        least rotation that turns its tangent there. Raises TurgorError for curves of Blender: make them anew.
        """
    def trimmed(self, start: float, end: float) -> Spine:
        """The part between two parameters, straight at its ends and rigid beyond: limits of the spine's reach.

        Trimmed alike, a rest spine and a pose of it keep matching stations. It deviates from this one near its ends.
        Raises TurgorError unless start < end, both within `parameter_range`.
        """
    @property
    def station_count(self) -> int: ...
    @property
    def station_parameters(self) -> NDArray[np.float64]:
        """(n,) parameter of each station."""
    @property
    def parameter_range(self) -> tuple[float, float]:
        """Parameters of the first and the last station; the frames are rigid beyond them and their run-outs."""
    @property
    def station_lengths(self) -> NDArray[np.float64]:
        """(n,) length of the curve from the first station to each."""
    @property
    def length(self) -> float:
        """Length from the first to the last station."""
    @property
    def resolution(self) -> int:
        """Samples per segment that the curve was made from; 1 where it passes through the points alone."""
    @property
    def deviation(self) -> float:
        """Largest distance of the given curve, at places between the samples, from this one; 0 where it is the same."""
    @property
    def fold_count(self) -> int:
        """Places where the tangent turns by more than a right angle at once: it folds back, no body can follow."""
    def evaluate(self, parameters: ArrayLike) -> SpineFrames:
        """Points and rotation-minimising frames at (M,) parameters, also beyond the ends."""
    def parameters_at(self, arc_lengths: ArrayLike) -> NDArray[np.float64]:
        """(M,) parameters at lengths along the curve from the first station; negative ones are before it."""
    def arc_lengths_at(self, parameters: ArrayLike) -> NDArray[np.float64]:
        """(M,) lengths along the curve from the first station to parameters."""
    def closest(self, points: ArrayLike) -> ClosestPoints:
        """The closest point of the curve to each of (M, 3) points, exact; beyond an end, on its tangent."""

@final
class SpineFrames:
    """Points of a spine with their frames; M rows each."""

    @property
    def positions(self) -> NDArray[np.float64]:
        """(M, 3)"""
    @property
    def tangents(self) -> NDArray[np.float64]:
        """(M, 3) unit vectors."""
    @property
    def normals(self) -> NDArray[np.float64]:
        """(M, 3) unit vectors: first axis of the normal plane, rotation-minimising."""
    @property
    def binormals(self) -> NDArray[np.float64]:
        """(M, 3) tangent × normal."""
    @property
    def curvatures(self) -> NDArray[np.float64]:
        """(M, 3) curvature vectors: to the centre of curvature, length 1 / radius."""
    @property
    def speeds(self) -> NDArray[np.float64]:
        """(M,) length of curve per parameter."""

@final
class ClosestPoints:
    """Closest points of a spine; M rows each."""

    @property
    def parameters(self) -> NDArray[np.float64]:
        """(M,)"""
    @property
    def positions(self) -> NDArray[np.float64]:
        """(M, 3)"""
    @property
    def distances(self) -> NDArray[np.float64]:
        """(M,)"""
    @property
    def is_beyond_ends(self) -> NDArray[np.bool_]:
        """(M,) before the first or after the last station."""
    @property
    def is_ambiguous(self) -> NDArray[np.bool_]:
        """(M,) another place of the spine is as near, or the point is a centre of curvature: no unique station."""

@final
class Fleshing:
    """Points bound to a rest spine: bends them along a posed one, every chunk keeping its volume (MATH 5).

    points: (N, 3) of anything: vertices, curve points, a cloud, a lattice; object space of both spines.
    kind: how flesh gives way in the normal plane, or weights (radial, normal, binormal) >= 0 of a blend; None: radial.
    match: which station of the posed spine is whose.
        "stations": the same parameter where both spines have the same parameters (see `Spine.posed`), else station by
        station and smoothly by length in between; "relative_length": the same part of the length; "length": the same
        length from the first station, so that the body is not stretched but lies along a path.
    influence: (N,) in [0, 1], part of the way that a point goes; None: 1.

    Immutable; safe to call from several threads. Raises TurgorError for shapes, values that are not finite or in range.
    """

    def __new__(
        cls,
        rest_spine: Spine,
        points: ArrayLike,
        kind: Kind | tuple[float, float, float] | None = None,
        *,
        match: Match = "stations",
        influence: ArrayLike | None = None,
    ) -> Fleshing: ...
    @property
    def rest_spine(self) -> Spine: ...
    @property
    def point_count(self) -> int: ...
    @property
    def stations(self) -> ClosestPoints:
        """Where each of the N points stands on the rest spine."""
    @property
    def memory_bytes(self) -> int:
        """Bound data."""
    def with_kind(self, kind: Kind | tuple[float, float, float]) -> Fleshing:
        """The same binding with another kind; the closest points are kept."""
    def deform(
        self,
        posed_spine: Spine,
        *,
        twist: float | ArrayLike | None = None,
        slide: float = 0.0,
        stretch: bool = True,
    ) -> NDArray[np.float64]:
        """(N, 3) fleshed positions, always finite.

        twist: radians about the tangent. One number: from 0 at the first station of the rest spine to it at the last,
            smoothly; (2,) angles at both ends; (n,) angle at each station; None: 0. Constant beyond the ends.
        slide: length by which the body glides along the posed spine.
        stretch: where the spine grows longer the body grows thinner by the root of that. False: not, and volume grows.
        Raises TurgorError for spines that do not match, wrong shapes and numbers that are not finite. Releases the GIL.
        """
    def deform_into(
        self,
        offsets: NDArray[np.float32],
        posed_spine: Spine,
        *,
        twist: float | ArrayLike | None = None,
        slide: float = 0.0,
        stretch: bool = True,
    ) -> FleshingReport:
        """As `deform`, writing fleshed - rest into `offsets`, (N, 3) float32 C-contiguous; allocates no array."""
    def deform_into_address(
        self,
        offsets_address: int,
        point_count: int,
        posed_spine: Spine,
        *,
        twist: float | ArrayLike | None = None,
        slide: float = 0.0,
        stretch: bool = True,
    ) -> FleshingReport:
        """As `deform_into`, at a raw address of point_count * 3 floats that the caller keeps alive."""
    def inverse(
        self,
        points: ArrayLike,
        posed_spine: Spine,
        *,
        twist: float | ArrayLike | None = None,
        slide: float = 0.0,
        stretch: bool = True,
    ) -> NDArray[np.float64]:
        """(M, 3) where any (M, 3) points about the posed spine come from. Influence is not looked at."""
    def validity(
        self,
        posed_spine: Spine,
        *,
        twist: float | ArrayLike | None = None,
        slide: float = 0.0,
        stretch: bool = True,
    ) -> Validity:
        """Where the map is exact. Projects every image on the posed spine: for overlays, not for each frame."""
    def valid_radii(
        self, posed_spine: Spine, parameters: ArrayLike, *, slide: float = 0.0, stretch: bool = True
    ) -> NDArray[np.float64]:
        """(M,) radius about the rest spine at (M,) parameters within which no point is clamped; inf if straight."""

@final
class FleshingReport:
    """Figures of one frame."""

    @property
    def clamped_count(self) -> int:
        """Points outside of the valid space of the posed curvature, held at its border."""
    @property
    def max_offset(self) -> float:
        """Largest |fleshed - rest|."""

@final
class Validity:
    """Where a frame is exact; N rows each."""

    @property
    def is_clamped(self) -> NDArray[np.bool_]:
        """(N,) beyond the border of the valid space of the posed curvature, held at it."""
    @property
    def is_overlapping(self) -> NDArray[np.bool_]:
        """(N,) the image lies nearer to another station of the posed spine: the body reaches into itself."""
    @property
    def is_ambiguous(self) -> NDArray[np.bool_]:
        """(N,) no unique station of the rest spine, see `ClosestPoints`."""
    @property
    def is_beyond_ends(self) -> NDArray[np.bool_]:
        """(N,) carried rigidly beyond the ends of the rest spine."""
    @property
    def usage(self) -> NDArray[np.float64]:
        """(N,) part of the way from the posed spine to the border of the valid space: exact below 1."""
    @property
    def valid_count(self) -> int:
        """Points that are neither clamped nor overlapping nor ambiguous."""

def flesh(
    points: ArrayLike,
    rest_spine: Spine,
    posed_spine: Spine,
    kind: Kind | tuple[float, float, float] | None = None,
    *,
    match: Match = "stations",
    influence: ArrayLike | None = None,
    twist: float | ArrayLike | None = None,
    slide: float = 0.0,
    stretch: bool = True,
) -> NDArray[np.float64]:
    """(N, 3) points bound to a rest spine and bent along a posed one, in one call; see `Fleshing`."""

@final
class Weights:
    """Weights of several meshes' vertices, N in all, one mesh after the other, and how they were found."""

    @property
    def offsets(self) -> NDArray[np.int32]:
        """(N + 1,) influences of vertex v are offsets[v]:offsets[v + 1], as `Skinning` takes them."""
    @property
    def bones(self) -> NDArray[np.int32]:
        """Bone of each influence: locked ones first, then by falling weight."""
    @property
    def weights(self) -> NDArray[np.float64]:
        """Above 0. Those of a vertex sum to 1, unless its locked ones alone are more."""
    @property
    def vertex_starts(self) -> NDArray[np.int32]:
        """(M + 1,) first vertex of each mesh, and N."""
    @property
    def is_fallback(self) -> NDArray[np.bool_]:
        """(N,) loose vertices and those of shells that no bone reaches inside of the body.

        They took from the nearest place of the body that a bone reaches.
        """
    @property
    def dimensions(self) -> tuple[int, int, int]:
        """Voxels along x, y, z; 0 where no mesh is solid: distances were straight then."""
    @property
    def voxel_size(self) -> float:
        """Edge of a voxel, in the unit of the positions."""
    @property
    def voxel_count(self) -> int:
        """Solid voxels."""
    @property
    def memory_bytes(self) -> int:
        """What the largest arrays took."""

def automatic_weights(
    meshes: Sequence[tuple[ArrayLike, ArrayLike, ArrayLike]],
    bone_heads: ArrayLike,
    bone_tails: ArrayLike,
    *,
    bone_parents: ArrayLike | None = None,
    resolution: int | None = None,
    falloff: float = 12.0,
    smoothing: float = 0.83,
    max_influences: int | None = 4,
    stiffness: ArrayLike | None = None,
    is_solid: ArrayLike | None = None,
    is_locked: ArrayLike | None = None,
    locked_weights: tuple[ArrayLike, ArrayLike, ArrayLike] | None = None,
    symmetry_plane: tuple[ArrayLike, ArrayLike] | None = None,
    mirrored_bones: ArrayLike | None = None,
    progress: Callable[[float], bool | None] | None = None,
) -> Weights:
    """Weights of every vertex on every mesh, whatever the meshes are like (MATH 6).

    Voxels fill the body, distances to bones are taken inside of it, and the skin evens out what follows from them:
    a tongue belongs to the jaw, not to the palate above it. Meshes may be open, inverted, in several shells, pass
    through themselves and each other.

    meshes: (positions (N, 3), face_offsets (F + 1,), face_corners (C,)) each, as `Mesh` takes them, in one space.
    bone_heads, bone_tails: (B, 3) in the same space. Only deform bones.
    bone_parents: (B,) -1 for none. Shells that overlap pass through each other unless bones lead there from one into
        the other: by parents, and where bones share an end.
    resolution: voxels along the longest side of the body, 8 to 1024, no more than 2 ** 24 of them solid; None: as many
        as the body needs. Parts two voxels apart are apart.
    falloff: exponent by which a bone's hold falls with distance, 0.5 to 32; larger is sharper.
    smoothing: length over which weights pass from bone to bone, in distances to the nearest bone, taken in the
        flesh, 0 to 10; 0: as they follow from distances.
    max_influences: bones per vertex; None: any number. Weights fade towards the limit, none is cut off.
    stiffness: (B,) > 0, a bone of 2 holds as if it were at half the distance; None: 1.
    is_solid: (M,) which meshes are the body; the others (clothes) take from its nearest place; None: all.
    is_locked, locked_weights: (B,) bones that keep their weights, and rows (offsets, bones, weights) over all vertices
        to find those in. Other bones share what is left.
    symmetry_plane: (point, normal), vertices that are mirror images get mirrored weights, bit by bit.
    mirrored_bones: (B,) partner of each bone, itself in the middle, -1 for none; None: the one at its image.
    progress: called with the part that is done, from this thread; returns False to cancel.

    The same for any number of threads. Raises TurgorError for wrong shapes, indices and ranges, and where every bone is
    locked; CancelledError. Releases the GIL.
    """
