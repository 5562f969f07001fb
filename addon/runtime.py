"""What lives while Blender runs and is never saved: states of characters and bodies, and of the session.

The dependency graph may ask for a correction on a worker thread: what is shown and bound is immutable and swapped as
a whole, and `lock` guards what is read before it is written.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Protocol
from uuid import uuid4

import bpy

from .logic.finding import Finding
from .logic.overlay_frame import OverlayFrame
from .logic.refined_region import Region
from .states import AnyState, SpineState, VolumeState

log = logging.getLogger("turgor")
lock = threading.RLock()


class ObjectsByName(Protocol):
    """Objects of Blender that can be looked up by name: `bpy.data.objects`, a view layer's."""

    def get(self, name: str, /) -> bpy.types.Object | None: ...

    def __iter__(self) -> Iterator[bpy.types.Object]: ...


class Look(Protocol):
    """What a viewport shows of an object with Turgor Volume; the same object again while nothing changed.

    None where there is nothing to show. For draw callbacks: what it returns lives while the viewport is drawn.
    """

    def __call__(self, ob: bpy.types.Object, /) -> OverlayFrame | None: ...


class LookRefined(Protocol):
    """What would be refined of an object with Turgor Volume; None where nothing is previewed. For draw callbacks."""

    def __call__(self, ob: bpy.types.Object, /) -> Region | None: ...


class FindModifier(Protocol):
    """The modifier Turgor Volume of an object, whatever its name is now; None where it has none."""

    def __call__(self, ob: bpy.types.Object, /) -> bpy.types.Modifier | None: ...


@dataclass(frozen=True)
class Bake:
    """A bake under way; part: 0 to 1."""

    part: float
    text: str


def _nothing(ob: bpy.types.Object, /) -> None:
    """What is seen of an object while no handler is registered."""


@dataclass
class Session:
    """State of the whole session; `route` is empty until it was chosen."""

    # By session uid of the object: with Turgor Volume, and with Turgor Spine.
    characters: dict[int, VolumeState] = field(default_factory=dict)
    spines: dict[int, SpineState] = field(default_factory=dict)
    waiting: set[int] = field(default_factory=set)
    route: str = ""
    route_reason: str = ""
    is_forced: bool = False
    is_started: bool = False
    is_rendering: bool = False
    is_quiet: bool = False
    # Whose twins were changed since they were evaluated.
    behind: set[int] = field(default_factory=set)
    bake: Bake | None = None
    # Tells files that were never saved from each other.
    unnamed: str = field(default_factory=lambda: uuid4().hex)
    # For panels and overlays, which know none of those who answer.
    look: Look = _nothing
    look_refined: LookRefined = _nothing
    find_modifier: FindModifier = _nothing


session = Session()


def forget_file() -> None:
    """Drop the states of all objects: another file was loaded, whose objects have other uids."""
    with lock:
        session.characters.clear()
        session.spines.clear()
        session.waiting.clear()
    session.unnamed = uuid4().hex


def character(uid: int) -> VolumeState:
    """The state of an object with Turgor Volume, by its session uid; made when it is first asked for."""
    with lock:
        return session.characters.setdefault(uid, VolumeState())


def spine(uid: int) -> SpineState:
    """The state of an object with Turgor Spine, by its session uid; made when it is first asked for."""
    with lock:
        return session.spines.setdefault(uid, SpineState())


def state_of(kind: str, uid: int) -> AnyState:
    """The state of an object by the kind of its carrier, "VOLUME" or "SPINE", and its session uid."""
    return spine(uid) if kind == "SPINE" else character(uid)


def object_of(uid: int, state: AnyState, objects: ObjectsByName) -> bpy.types.Object | None:
    """The object among `objects` that has this session uid and state; None where there is none.

    By the name it had, which is fast; names alone do not tell, since linked objects may bear the same.
    """
    ob = objects.get(state.name)
    if ob is None or ob.session_uid != uid:
        ob = next((other for other in objects if other.session_uid == uid), None)
        state.name = state.name if ob is None else ob.name
    return ob


def set_bind_findings(state: AnyState, name: str, findings: tuple[Finding, ...]) -> None:
    """Keep and log what a bind found, in place of all that was off before. name: of the object, for the log."""
    with lock:
        state.bind_findings, state.failure = findings, None
        if state.problem is not None:
            state.forget_frame()
    log_findings(state, name, findings)


def set_failure(state: AnyState, name: str, failure: Finding | None) -> None:
    """Keep and log why a frame shows the mesh without ours; None when it does not. name: of the object."""
    with lock:
        state.failure = failure
        if failure is None:
            return
        state.forget_frame()
    log_findings(state, name, (failure,))


def log_findings(state: AnyState, name: str, findings: Iterable[Finding]) -> None:
    """Log a line for each finding, once per file. name: of the object."""
    with lock:
        news = [finding for finding in findings if finding.logged_as not in state.logged]
        state.logged.update(finding.logged_as for finding in news)
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
