"""Texts that name things of the scene: English where they are made, in the artist's language where they are drawn.

A message is its English text, so logs, errors and tests read it as it stands; it remembers the template it was filled
from, which is what translators translate.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

# Volume errors from here on are rounded as roughly as those of plain skinning.
VISIBLE_PERCENT = 0.005


class Message(str):
    """A filled template."""

    __slots__ = ("template", "values")

    template: str
    values: Mapping[str, object]


def message(template: str, /, **values: object) -> Message:
    """`template` as `str.format` takes it, with its values."""
    filled = Message(template.format(**values))
    filled.template, filled.values = template, values
    return filled


def of_error(error: BaseException) -> str:
    """The message that an error was made with."""
    first = error.args[0] if error.args else ""
    return first if isinstance(first, str) and first else str(error) or repr(error)


def translated(text: str, translate: Callable[[str], str]) -> str:
    """`text` in the artist's language; values that are messages are translated too."""
    if not isinstance(text, Message):
        return translate(text)
    values = {
        name: translated(value, translate) if isinstance(value, Message) else value
        for name, value in text.values.items()
    }
    return translate(text.template).format(**values)


def signed_percent(value: float, digits: int) -> str:
    """A percentage as text, with a sign unless it rounds to zero."""
    rounded = round(value, digits)
    return f"{rounded:+.{digits}f} %" if rounded else f"{0.0:.{digits}f} %"


def volume_error(percent: float) -> str:
    """A volume error as text, with more digits where it is next to nothing."""
    return signed_percent(percent, 2 if abs(percent) >= VISIBLE_PERCENT else 4)
