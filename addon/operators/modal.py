"""Operators that run beside a window: work is done piece by piece on a timer, Esc cancels, progress is shown.

Without a window the same work runs to its end at once.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from time import perf_counter
from typing import ClassVar, Protocol

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..messages import of_error, translated

# How far work has come: a part, 0 to 1, and what is being done.
Progress = tuple[float, str]


class Work(Protocol):
    """Something long. Each method may raise what the operator refuses with."""

    def run(self) -> None:
        """All of it, at once."""
        ...

    def start(self) -> None:
        """Begin; `advance` goes on."""
        ...

    def advance(self) -> Progress | None:
        """Do a little, shortly enough for a window to stay alive. None when all is done."""
        ...

    def stop(self) -> None:
        """Leave nothing running or half done; also where all is done or has failed."""
        ...


class Steps:
    """Work in small steps on the main thread, as many at a time as fit between two redraws of the window."""

    SECONDS_OF_WORK = 0.1

    def __init__(self, steps: Iterator[Progress]) -> None:
        """steps: a generator; it is closed when the work stops."""
        self._steps = steps

    def run(self) -> None:
        """All steps."""
        with closing(self._steps):
            for _ in self._steps:
                pass

    def start(self) -> None:
        """Nothing is done before the first `advance`."""

    def advance(self) -> Progress | None:
        """Take as many steps as fit between two redraws, at least one."""
        until = perf_counter() + self.SECONDS_OF_WORK
        while True:
            progress = next(self._steps, None)
            if progress is None or perf_counter() >= until:
                return progress

    def stop(self) -> None:
        """Close the steps."""
        self._steps.close()


class Threaded:
    """Work in a thread of its own, which touches nothing of Blender."""

    def __init__(self, work: Callable[[Callable[[float], bool]], None]) -> None:
        """work: is given what to tell its progress, 0 to 1, to, which answers whether to go on."""
        self._work = work
        self._part = 0.0
        self._is_stopped = False
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)

    def run(self) -> None:
        """All of it, in the thread that calls."""
        self._work(lambda part: True)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def advance(self) -> Progress | None:
        """How far the thread is; raises what it raised."""
        if self._thread.is_alive():
            return self._part, ""
        if self._error is not None:
            raise self._error
        return None

    def stop(self) -> None:
        """Have the work end, and wait until it has."""
        self._is_stopped = True
        self._thread.join()

    def _run(self) -> None:
        def go_on(part: float) -> bool:
            self._part = part
            return not self._is_stopped

        try:
            self._work(go_on)
        except BaseException as error:  # raised again where the main thread looks
            self._error = error


class ModalOperator:
    """A base of operators; those say what is done, what is shown meanwhile, and what comes of it."""

    # Errors that are told the artist; all others are bugs and reach Blender.
    refusals: ClassVar[tuple[type[Exception], ...]]
    seconds_between_steps: ClassVar[float]
    # What is reported after Esc.
    cancelled: ClassVar[str]

    def begin(self, context: bpy.types.Context) -> Work:
        """Read what the work needs. Raises one of the `refusals`."""
        raise NotImplementedError

    def status(self, progress: Progress) -> str:
        """The line at the window's lower edge."""
        raise NotImplementedError

    def finish(self, context: bpy.types.Context) -> set[str]:
        """Write what the work came to, after its end; returns what `execute` does."""
        raise NotImplementedError

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            self.begin(context).run()
        except self.refusals as error:
            return self._refuse(error)
        return self.finish(context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return self.execute(context) if bpy.app.background or context.window is None else self.run_beside(context)

    def run_beside(self, context: bpy.types.Context) -> set[str]:
        """Begin, and leave the rest to `modal`."""
        try:
            self._running = self.begin(context)
        except self.refusals as error:
            return self._refuse(error)
        manager = context.window_manager
        self._timer = manager.event_timer_add(self.seconds_between_steps, window=context.window)
        manager.progress_begin(0, 100)
        manager.modal_handler_add(self)
        self._running.start()
        self.show(context, (0.0, "Begins"))
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Nothing else is let through: what was read must not change under way."""
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.report({"INFO"}, rpt_(self.cancelled))
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        try:
            progress = self._running.advance()
        except BaseException as error:
            self.cancel(context)
            if isinstance(error, self.refusals):
                return self._refuse(error)
            raise
        if progress is not None:
            self.show(context, progress)
            return {"RUNNING_MODAL"}
        self.cancel(context)
        return self.finish(context)

    def cancel(self, context: bpy.types.Context) -> None:
        """End the work and all that was shown of it; Blender calls it where it closes the window or the file."""
        try:
            self._running.stop()
        finally:
            context.window_manager.event_timer_remove(self._timer)
            context.window_manager.progress_end()
            context.workspace.status_text_set(None)

    def show(self, context: bpy.types.Context, progress: Progress) -> None:
        """Show how far the work has come."""
        context.window_manager.progress_update(int(100 * progress[0]))
        context.workspace.status_text_set(self.status(progress))

    def _refuse(self, error: Exception) -> set[str]:
        self.report({"ERROR"}, translated(of_error(error), rpt_))
        return {"CANCELLED"}


@contextmanager
def progress_shown(context: bpy.types.Context, count: int) -> Iterator[Callable[[int], None]]:
    """Show progress at the mouse while the window waits; gives what to tell how many of `count` are done."""
    manager = context.window_manager
    manager.progress_begin(0, max(count, 1))
    try:
        yield manager.progress_update
    finally:
        manager.progress_end()
