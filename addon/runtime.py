"""What lives while Blender runs and is never saved: bound engines, figures of the last frame, problems.

The dependency graph may ask for a correction on a worker thread: what is shown and bound is immutable and swapped as
a whole, and `lock` guards what is read before it is written.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterator
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
class Figures:
    """One frame of a character in the viewport. Deviations in percent of the volume at full strength."""

    corrected_deviation: float
    skinned_deviation: float
    joints: dict[str, JointFigures]


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


@dataclass
class Character:
    """One object with one modifier of ours."""

    name: str = ""  # of the object, when it was last evaluated
    body: Any = None  # live.binding.Bound, live.spine_binding.Bound
    signature: tuple[object, ...] = ()
    problem: str | None = None
    logged: set[str] = field(default_factory=set)
    needs_rebind: bool = False
    is_stale: bool = False
    notes: tuple[str, ...] = ()
    # Works out `figures`: called when a panel is drawn, since most frames are looked at by nobody.
    measure: Callable[[], Any] | None = None
    timing: Timing | None = None
    # Works out what an overlay draws, `logic.sketch.Sketch`.
    sketch: Callable[[], Any] | None = None
    # Works out the error of small volumes, `logic.sketch.LocalError`.
    local_error: Callable[[], Any] | None = None

    @property
    def figures(self) -> Any:
        """Of the last frame in the viewport, `Figures` or `SpineFigures`; None when there are none."""
        measure = self.measure
        return None if measure is None else measure()


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


def known(kind: str, uid: int) -> Character:
    """By the carrier's kind."""
    return spine(uid) if kind == "SPINE" else character(uid)


def set_problem(known: Character, name: str, problem: str | None) -> None:
    """Show a problem in the panel and write it to the log, each one once per file."""
    with lock:
        known.problem = problem
        if problem is None:
            return
        known.measure = known.timing = known.sketch = known.local_error = None
        is_news = problem not in known.logged
        known.logged.add(problem)
    if is_news:
        log.warning("%s: %s", name, problem)


@contextmanager
def quiet() -> Iterator[None]:
    """Handlers do nothing within: the add-on itself is evaluating."""
    before, session.is_quiet = session.is_quiet, True
    try:
        yield
    finally:
        session.is_quiet = before
