"""Operators that run beside a window: however they end, nothing of them is left behind."""

from __future__ import annotations

import importlib
from collections import Counter
from types import ModuleType, SimpleNamespace

import pytest


class Window:
    """A context that counts what is begun and what is ended."""

    def __init__(self) -> None:
        self.window = object()
        self.counts: Counter[str] = Counter()
        self.percents: list[int] = []
        self.statuses: list[str | None] = []
        self.window_manager = self
        self.workspace = SimpleNamespace(status_text_set=self.statuses.append)

    def event_timer_add(self, _seconds: float, *, window: object) -> object:
        assert window is self.window
        self.counts["timers"] += 1
        return self

    def event_timer_remove(self, timer: object) -> None:
        assert timer is self
        self.counts["timers"] -= 1

    def progress_begin(self, _least: int, _most: int) -> None:
        self.counts["progresses"] += 1

    def progress_end(self) -> None:
        self.counts["progresses"] -= 1

    def progress_update(self, percent: int) -> None:
        self.percents.append(percent)

    def modal_handler_add(self, _operator: object) -> None:
        self.counts["handlers"] += 1

    @property
    def is_clean(self) -> bool:
        return self.counts["timers"] == self.counts["progresses"] == 0 and self.statuses[-1] is None


class RefusedError(ValueError):
    """What the operators below tell the artist."""


TIMER, ESCAPE, CLICK = (
    SimpleNamespace(type=kind, value=value)
    for kind, value in (("TIMER", "NOTHING"), ("ESC", "PRESS"), ("LEFTMOUSE", "PRESS"))
)


@pytest.fixture
def modal() -> ModuleType:
    return importlib.import_module("addon.operators.modal")


def stepwise(modal: ModuleType, fault: BaseException | None) -> tuple[object, list[str]]:
    """Three steps, then a fault or the end; and what was done."""
    done: list[str] = []

    def steps():
        try:
            for part in (0.25, 0.5, 0.75):
                done.append(f"{part}")
                yield part, "works"
            if fault is not None:
                raise fault
        finally:
            done.append("closed")

    work = modal.Steps(steps())
    work.SECONDS_OF_WORK = 0.0
    return work, done


def threaded(modal: ModuleType, fault: BaseException | None) -> tuple[object, list[str]]:
    """The same in a thread; steps are told as it is asked whether to go on."""
    done: list[str] = []

    def work(go_on) -> None:
        try:
            for part in (0.25, 0.5, 0.75):
                done.append(f"{part}")
                if not go_on(part):
                    return
            if fault is not None:
                raise fault
        finally:
            done.append("closed")

    return modal.Threaded(work), done


@pytest.fixture(params=[stepwise, threaded])
def operator(request: pytest.FixtureRequest, modal: ModuleType):
    """Makes an operator whose work ends in a fault or well."""

    def made(fault: BaseException | None = None):
        work, done = request.param(modal, fault)

        class Operator(modal.ModalOperator):
            refusals = (RefusedError,)
            seconds_between_steps = 0.01
            cancelled = "left off"

            def __init__(self) -> None:
                self.done, self.reports = done, []

            def begin(self, context: Window) -> object:
                assert not context.counts
                return work

            def status(self, progress: tuple[float, str]) -> str:
                return f"{progress[0]:.2f}"

            def finish(self, context: Window) -> set[str]:
                assert context.counts["timers"] == 0
                self.done.append("finished")
                return {"FINISHED"}

            def report(self, kinds: set[str], text: str) -> None:
                self.reports.append((*kinds, text))

        return Operator()

    return made


def run(operator, window: Window) -> set[str]:
    """All of it, by ticks of the timer."""
    result = operator.run_beside(window)
    while result == {"RUNNING_MODAL"}:
        result = operator.modal(window, TIMER)
    return result


def test_work_that_ends_well_is_finished_once(operator):
    window, made = Window(), operator()
    assert run(made, window) == {"FINISHED"}
    assert made.done == ["0.25", "0.5", "0.75", "closed", "finished"]
    assert window.is_clean
    assert not made.reports


def test_without_a_window_the_same_is_done_at_once(operator):
    made = operator()
    window = Window()
    assert made.invoke(window, TIMER) == {"FINISHED"}
    assert made.done == ["0.25", "0.5", "0.75", "closed", "finished"]
    assert not window.counts


def test_a_refusal_is_told_and_nothing_is_finished(operator):
    window, made = Window(), operator(RefusedError("too long: shorten it"))
    assert run(made, window) == {"CANCELLED"}
    assert made.reports == [("ERROR", "too long: shorten it")]
    assert "finished" not in made.done
    assert window.is_clean


def test_a_refusal_without_a_window_is_told(operator):
    made = operator(RefusedError("too long: shorten it"))
    assert made.execute(Window()) == {"CANCELLED"}
    assert made.reports == [("ERROR", "too long: shorten it")]


def test_a_fault_reaches_blender_and_leaves_nothing_behind(operator):
    window, made = Window(), operator(ZeroDivisionError("a bug"))
    with pytest.raises(ZeroDivisionError):
        run(made, window)
    assert "finished" not in made.done
    assert window.is_clean


@pytest.mark.parametrize("ticks", [0, 1, 2])
def test_escape_stops_the_work_and_says_so(operator, ticks):
    window, made = Window(), operator()
    made.run_beside(window)
    for _ in range(ticks):
        assert made.modal(window, CLICK) == {"RUNNING_MODAL"}
    assert made.modal(window, ESCAPE) == {"CANCELLED"}
    assert made.reports == [("INFO", "left off")]
    assert "finished" not in made.done
    assert window.is_clean


def test_blender_may_end_it(operator):
    window, made = Window(), operator()
    made.run_beside(window)
    made.cancel(window)
    assert "finished" not in made.done
    assert window.is_clean


def test_progress_is_shown_from_the_start(operator):
    window, made = Window(), operator()
    made.run_beside(window)
    assert (window.percents, window.statuses) == ([0], ["0.00"])
    while made.modal(window, TIMER) == {"RUNNING_MODAL"}:
        assert window.statuses[-1] == f"{window.percents[-1] / 100:.2f}"
    assert window.percents == sorted(window.percents)


def test_progress_beside_the_mouse_ends_with_the_work(modal):
    window = Window()

    def fail() -> None:
        with modal.progress_shown(window, 3) as tell:
            tell(2)
            raise RefusedError

    with pytest.raises(RefusedError):
        fail()
    assert window.percents == [2]
    assert not window.counts["progresses"]
