"""What lives while Blender runs and is never saved: bound engines, figures of the last frame, problems.

The dependency graph may ask for a correction on a worker thread: what is shown and bound is immutable and swapped as
a whole, and `lock` guards what is read before it is written.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

log = logging.getLogger("turgor")
lock = threading.RLock()


@dataclass(frozen=True)
class JointFigures:
    """Percent of the rest volume."""

    lost: float
    regained: float
    is_capped: bool


@dataclass(frozen=True)
class Folds:
    """Pairs of triangles that the correction alone makes pass through each other, and vertices held against that."""

    found_count: int
    left_count: int
    blocked_count: int


@dataclass(frozen=True)
class Figures:
    """One frame of a character in the viewport. Deviations in percent of the volume at full strength."""

    # As the engine says of its own solution, and of skinning.
    corrected_deviation: float
    skinned_deviation: float
    # Measured on the mesh that the viewport shows; None where that has other vertices than were bound.
    shown_deviation: float | None
    joints: dict[str, JointFigures]
    folds: Folds | None = None  # where they are repaired


@dataclass(frozen=True)
class Motion:
    """A character over many poses, as `Figures` of each: F poses, J joints. Arrays of numpy."""

    # (F,) of the scene, rising; None: poses of the test range of motion, which has no time.
    frames: Any
    corrected_deviations: Any  # (F,) percent
    skinned_deviations: Any  # (F,) percent
    joint_names: tuple[str, ...]
    joint_losses: Any  # (F, J) percent of the rest volume
    # Largest loss of each joint in the unit of `TurgorJoint.fold_loss`.
    fold_losses: dict[str, float]


@dataclass(frozen=True)
class SpineFigures:
    """One frame of a fleshed body. Deviations in percent of the rest volume; None where nothing encloses one."""

    point_count: int
    clamped_count: int
    fleshed_deviation: float | None
    kept_deviation: float | None


@dataclass(frozen=True)
class Timing:
    """One frame, milliseconds."""

    read: float
    engine: float
    write: float

    @property
    def total(self) -> float:
        return self.read + self.engine + self.write


# From worst to least: the mesh is as it would be without ours; something is not as it should be; good to know.
SEVERITIES = ("ERROR", "WARNING", "INFO")


@dataclass(frozen=True)
class Finding:
    """Something that is off with a character."""

    id: str  # stable, for scripts and tests
    severity: str  # of SEVERITIES
    text: str  # a sentence for the artist: what was found, what to do
    fix: str = ""  # of properties.fixes; empty where there is none
    subject: str = ""  # what the fix changes: name of a modifier, bone or vertex group
    refusal: str = ""  # why the fix cannot be applied here

    @property
    def logged_as(self) -> tuple[str, ...]:
        """Equal for findings of which the log holds one; what is only good to know comes with figures of a frame."""
        return (self.id, self.subject) if self.severity == "INFO" else (self.text,)


class Once:
    """A value that is worked out when it is first asked for. Made in every frame: `functools.cache` takes longer."""

    __slots__ = ("_value", "_work")

    def __init__(self, work: Callable[[], Any]) -> None:
        self._work: Callable[[], Any] | None = work
        self._value: Any = None

    def __call__(self) -> Any:
        work = self._work
        if work is not None:
            self._value = work()
            self._work = None
        return self._value


@dataclass
class Character:
    """One object with one modifier of ours."""

    name: str = ""  # of the object, when it was last evaluated
    body: Any = None  # live.binding.Bound, live.spine_binding.Bound
    signature: tuple[object, ...] = ()
    settled: Any = None  # settings of the last frame, live.engines.Settled
    # What the last bind found, and the state of the stack around ours; why the last frame failed.
    bind_findings: tuple[Finding, ...] = ()
    mask_findings: tuple[Finding, ...] = ()
    state_findings: tuple[Finding, ...] = ()
    state: tuple[object, ...] = ()
    failure: Finding | None = None
    logged: set[tuple[str, ...]] = field(default_factory=set)
    is_stale: bool = False
    # What binding and reading the masks cost when it was last done.
    bind_seconds: float = 0.0
    mask_seconds: float = 0.0
    # Works out `figures`: called when a panel is drawn, since most frames are looked at by nobody.
    measure: Callable[[], Any] | None = None
    # Works out what is off in the last frame, as `measure`.
    inspect: Callable[[], tuple[Finding, ...]] | None = None
    timing: Timing | None = None
    # What was measured over the frames; None: not in this session.
    motion: Motion | None = None
    # What that motion asks for where more vertices are wanted, `live.refining.Found`.
    refinement: Any = None
    # Name of the armature's active bone when it was last looked at; None: not yet.
    active_bone: str | None = None
    # Works out what an overlay draws, `logic.sketch.Sketch`.
    sketch: Callable[[], Any] | None = None
    # Works out the error of small volumes, `logic.sketch.LocalError`.
    local_error: Callable[[], Any] | None = None

    @property
    def figures(self) -> Any:
        """Of the last frame in the viewport, `Figures` or `SpineFigures`; None when there are none."""
        measure = self.measure
        return None if measure is None else measure()

    @property
    def findings(self) -> tuple[Finding, ...]:
        """All that is off now, the worst first; for panels, since those of the frame are worked out here."""
        inspect, failure = self.inspect, self.failure
        of_frame = () if inspect is None else inspect()
        failed = () if failure is None else (failure,)
        found = (*self.bind_findings, *failed, *self.mask_findings, *self.state_findings, *of_frame)
        return tuple(sorted(found, key=lambda finding: SEVERITIES.index(finding.severity)))

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


@dataclass(frozen=True)
class Bake:
    """A bake under way; part: 0 to 1."""

    part: float
    text: str


@dataclass
class Session:
    """State of the whole session; `route` is empty until it was chosen."""

    # By session uid of the object: with Turgor Volume, and with Turgor Spine.
    characters: dict[int, Character] = field(default_factory=dict)
    spines: dict[int, Character] = field(default_factory=dict)
    waiting: set[int] = field(default_factory=set)
    route: str = ""
    route_reason: str = ""
    is_forced: bool = False
    is_started: bool = False
    is_rendering: bool = False
    is_quiet: bool = False
    bake: Bake | None = None
    # What a viewport shows of an object with Turgor Volume, `logic.shown.Shown`; for draw callbacks.
    look: Callable[[Any], Any] | None = None
    # What of it would be refined, `logic.refined_region.Region`.
    look_refined: Callable[[Any], Any] | None = None
    # Its modifier Turgor Volume, whatever its name is now, or None.
    find_modifier: Callable[[Any], Any] = lambda ob: None


session = Session()


def forget_file() -> None:
    """Another file was loaded: its objects have other uids."""
    with lock:
        session.characters.clear()
        session.spines.clear()
        session.waiting.clear()


def character(uid: int) -> Character:
    with lock:
        return session.characters.setdefault(uid, Character())


def spine(uid: int) -> Character:
    with lock:
        return session.spines.setdefault(uid, Character())


def object_of(uid: int, known: Character, objects: Any) -> Any:
    """What is known as `known`, among objects of Blender that can be looked up by name; None where it is not.

    By the name it had, which is fast; names alone do not tell, since linked objects may bear the same.
    """
    ob = objects.get(known.name)
    if ob is None or ob.session_uid != uid:
        ob = next((other for other in objects if other.session_uid == uid), None)
        known.name = known.name if ob is None else ob.name
    return ob


def known(kind: str, uid: int) -> Character:
    """By the carrier's kind."""
    return spine(uid) if kind == "SPINE" else character(uid)


def set_bind_findings(known: Character, name: str, findings: tuple[Finding, ...]) -> None:
    """What a bind found, in place of all that was off before."""
    with lock:
        known.bind_findings, known.failure = findings, None
        if known.problem is not None:
            _forget_frame(known)
    log_findings(known, name, findings)


def set_failure(known: Character, name: str, failure: Finding | None) -> None:
    """Why a frame shows the mesh without ours; None when it does not."""
    with lock:
        known.failure = failure
        if failure is None:
            return
        _forget_frame(known)
    log_findings(known, name, (failure,))


def _forget_frame(known: Character) -> None:
    known.measure = known.inspect = known.timing = known.sketch = known.local_error = None


def log_findings(known: Character, name: str, findings: Iterable[Finding]) -> None:
    """A line for each, once per file."""
    with lock:
        news = [finding for finding in findings if finding.logged_as not in known.logged]
        known.logged.update(finding.logged_as for finding in news)
    for finding in news:
        log.log(logging.INFO if finding.severity == "INFO" else logging.WARNING, "%s: %s", name, finding.text)


@contextmanager
def quiet() -> Iterator[None]:
    """Handlers do nothing within: the add-on itself is evaluating."""
    before, session.is_quiet = session.is_quiet, True
    try:
        yield
    finally:
        session.is_quiet = before
