"""What is kept of an object with a modifier of ours while Blender runs: its binding, its last frame, what is off.

Nothing here is saved. What a frame leaves behind is swapped as a whole, since the dependency graph may ask for a
correction on a worker thread.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import ClassVar, Generic, NamedTuple, TypeVar

import numpy as np
import turgor
from numpy.typing import NDArray

from .logic.body import Body
from .logic.character_figures import Motion, SpineFigures, Timing, VolumeFigures
from .logic.finding import Finding, worst_first
from .logic.flesh import Flesh
from .logic.profiles import Curves
from .logic.refined_region import MotionNeed
from .logic.spine_sketch import LocalError, Sketch
from .scene.settings import BodySettings
from .scene.skeleton import RestBones
from .scene.spine_curve import SplinePoints
from .scene.stack import Animated


class EvaluatedStack(NamedTuple):
    """How a character is read whose stack Blender evaluates for us."""

    shape_deltas: NDArray[np.float32]  # (K, N, 3)
    has_body: bool  # the body is another one on every frame
    corners: NDArray[np.int32] | None  # (C,) of the faces, where a modifier may make others on every frame
    suspect: str  # name of that modifier; empty without one


class VolumeBinding(NamedTuple):
    """A character's engine and what a frame needs to call it."""

    body: Body
    bones: RestBones
    rig: int  # session uid of the armature's object
    content: str  # fingerprint of the mesh, weights and bones that were bound
    placement: NDArray[np.float64]  # (4, 4) object_from_armature that was bound
    curves: Curves
    fleshed: list[bool] | None  # per bone, whether Turgor Spine moves its flesh; None where it moves none
    unweighted_count: int  # vertices that no bone holds
    group_names: tuple[str, ...]  # of all vertex groups
    masked_by: tuple[str, bool, str]  # `live.masks.chosen`
    weighed: NDArray[np.float64] | None  # `placement.corners` where weights depend on where the mesh stands
    evaluated: EvaluatedStack | None  # None where the engine skins by itself


class SpineBinding(NamedTuple):
    """A body and its spine at rest, in the spine's own space."""

    flesh: Flesh
    content: str  # fingerprint of the mesh and of who follows
    placement: NDArray[np.float64]  # (4, 4) object_from_spine that was bound
    chain: tuple[str, ...]  # names of its bones; empty for curves
    rest_bones: tuple[NDArray[np.float64], NDArray[np.float64]] | None  # `scene.spine_chain.read_rest`
    rest_curve: SplinePoints | None
    limb_bones: RestBones | None  # those that skin a limb
    chosen: tuple[object, ...]  # `scene.spine_stack.chosen`


class SettledEngine(NamedTuple):
    """The engine under the settings of an evaluated copy, while the copy bears the mark."""

    mark: int
    bound: VolumeBinding
    saved: BodySettings
    engine: turgor.VolumeSkin
    strengths: NDArray[np.float64]  # (J,) of the joints
    armature: int | None  # its place in the stack


Binding = TypeVar("Binding")
Figures = TypeVar("Figures")


@dataclass
class ModifierState(Generic[Binding, Figures]):
    """One object with one modifier of ours."""

    # Fields that the last frame leaves.
    FRAME_FIELDS: ClassVar[tuple[str, ...]] = ("measure", "inspect", "timing", "failure", "later_findings")

    name: str = ""  # of the object, when it was last evaluated
    binding: Binding | None = None
    signature: tuple[object, ...] = ()  # of the stack that was bound
    # What the last bind found, and what stands around our modifier; why the last frame failed.
    bind_findings: tuple[Finding, ...] = ()
    stack_findings: tuple[Finding, ...] = ()
    stack_state: tuple[object, ...] = ()  # for which `stack_findings` were found
    failure: Finding | None = None
    logged: set[tuple[str, ...]] = field(default_factory=set)
    is_stale: bool = False
    # Works out `figures`: called when a panel is drawn, since most frames are looked at by nobody.
    measure: Callable[[], Figures] | None = None
    # Works out what is off in the last frame, as `measure`.
    inspect: Callable[[], tuple[Finding, ...]] | None = None
    timing: Timing | None = None
    # What measured meshes said of a frame, and the fingerprint of what was looked at last.
    later_findings: tuple[Finding, ...] = ()
    later_seen: str = ""

    @property
    def figures(self) -> Figures | None:
        """Figures of the last frame in the viewport; None when there are none."""
        measure = self.measure
        return None if measure is None else measure()

    @property
    def standing_findings(self) -> tuple[Finding, ...]:
        """What is off around our modifier, whatever the frame and the last bind."""
        return self.stack_findings

    @property
    def findings(self) -> tuple[Finding, ...]:
        """All that is off now, the worst first; for panels, since those of the frame are worked out here."""
        inspect, failure = self.inspect, self.failure
        of_frame = () if inspect is None else inspect()
        failed = () if failure is None else (failure,)
        return worst_first((*self.bind_findings, *failed, *self.standing_findings, *of_frame, *self.later_findings))

    @property
    def problem(self) -> str | None:
        """Why the mesh is as it would be without ours; None when it is not."""
        failure = self.failure
        found = (*self.bind_findings, *(() if failure is None else (failure,)))
        return next((finding.text for finding in found if finding.severity == "ERROR"), None)

    @property
    def needs_rebind(self) -> bool:
        """Whether the artist has to agree to another mesh."""
        return any(finding.fix == "REBIND" for finding in self.bind_findings)

    def forget_frame(self) -> None:
        """Drop all that the last frame left: it is shown no longer."""
        self.measure = self.inspect = self.timing = None
        self.later_findings, self.later_seen = (), ""

    @contextmanager
    def frame_kept(self) -> Iterator[None]:
        """After it the last frame is the one before it, whatever is evaluated within."""
        before = [(name, getattr(self, name)) for name in self.FRAME_FIELDS]
        try:
            yield
        finally:
            for name, value in before:
                setattr(self, name, value)


@dataclass
class VolumeState(ModifierState[VolumeBinding, VolumeFigures]):
    """One character: an object with Turgor Volume."""

    settled: SettledEngine | None = None  # of the last frame
    animated: Animated = field(default_factory=dict)  # settings before ours, of an evaluated stack
    in_step: int = -1  # what evaluated copies bear that were found to be as they were bound, see `live.twins`
    mask_findings: tuple[Finding, ...] = ()
    # What binding and reading the masks cost when it was last done.
    bind_seconds: float = 0.0
    mask_seconds: float = 0.0
    # What was measured over the frames; None: not in this session.
    motion: Motion | None = None
    # What the motion asks for where more vertices are wanted.
    refinement: MotionNeed | None = None
    # Name of the armature's active bone when it was last looked at; None: not yet.
    active_bone: str | None = None

    @property
    def standing_findings(self) -> tuple[Finding, ...]:
        """What is off with the masks and around our modifier, whatever the frame and the last bind."""
        return (*self.mask_findings, *self.stack_findings)


@dataclass
class SpineState(ModifierState[SpineBinding, SpineFigures]):
    """One body: an object with Turgor Spine."""

    FRAME_FIELDS = (*ModifierState.FRAME_FIELDS, "sketch", "local_error")

    # Works out what an overlay draws.
    sketch: Callable[[], Sketch] | None = None
    # Works out the error of small volumes.
    local_error: Callable[[], LocalError] | None = None

    def forget_frame(self) -> None:
        """Drop all that the last frame left: it is shown no longer."""
        super().forget_frame()
        self.sketch = self.local_error = None


AnyState = VolumeState | SpineState
