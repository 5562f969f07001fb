"""Arguments that several commands take."""

from __future__ import annotations

import argparse
from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from ..logic import compared_frames, frame_range


class Part(NamedTuple):
    """The `number`-th of `count` workers, from 1."""

    number: int
    count: int

    def of(self, item_count: int) -> range:
        """Its share of so many items; the shares of all workers are all items, each once."""
        return range((self.number - 1) * item_count // self.count, self.number * item_count // self.count)


def add_objects(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--object", action="append", default=[], dest="objects", metavar="NAME", help="only this one; repeat for more"
    )


def add_frames(parser: argparse.ArgumentParser, default: str = "the scene's") -> None:
    parser.add_argument(
        "--frames",
        type=frames,
        metavar="RANGE",
        help=f"1-100, 1-100x2 for every second one, 1-100x0.25 for steps within, or 3,7,20-30 (default: {default})",
    )


def add_part(parser: argparse.ArgumentParser, what: str) -> None:
    parser.add_argument(
        "--part", type=part, metavar="K/N", help=f"{what} that falls to the K-th of N workers, each on its own machine"
    )


def add_switch(parser: argparse.ArgumentParser, name: str, what: str) -> None:
    """`--name` alone, or with `=on` or `=off` for programs that fill in a template."""
    parser.add_argument(name, nargs="?", const=True, default=False, type=switch, metavar="on|off", help=what)


def add_live_frames(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--live-frames",
        type=count,
        default=compared_frames.MOST_FRAMES,
        metavar="N",
        help="frames that are compared with the live character: the ends, the worst ones of joints and some between;"
        " 0: all (default: %(default)s)",
    )


def add_progress(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--progress", choices=("none", "openjd"), default="none", help="how to tell the progress (default: %(default)s)"
    )


def switch(text: str) -> bool:
    """Raises argparse.ArgumentTypeError."""
    if text not in {"on", "off"}:
        raise argparse.ArgumentTypeError(f"need on or off, got {text}")
    return text == "on"


def count(text: str) -> int:
    """Raises argparse.ArgumentTypeError."""
    if not (text.isascii() and text.isdecimal()):
        raise argparse.ArgumentTypeError(f"need a whole number from 0 on, got {text}")
    return int(text)


def frames(text: str) -> NDArray[np.float64]:
    """(F,) times. Raises argparse.ArgumentTypeError."""
    try:
        return frame_range.parse(text)
    except frame_range.FrameRangeError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def part(text: str) -> Part:
    """Raises argparse.ArgumentTypeError."""
    number, _, count = text.partition("/")
    if not (number.isdecimal() and count.isdecimal() and 1 <= int(number) <= int(count)):
        raise argparse.ArgumentTypeError(f"{text!r}: need K/N, such as 2/8 for the second of eight")
    return Part(int(number), int(count))


def chosen_frames(arguments: argparse.Namespace, scene: bpy.types.Scene) -> NDArray[np.float64]:
    """(F,) the frames that were asked for, or all frames of the scene."""
    if arguments.frames is not None:
        return arguments.frames
    return frame_range.steps(scene.frame_start, scene.frame_end, max(scene.frame_step, 1))
