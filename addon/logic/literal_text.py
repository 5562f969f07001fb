"""Python literals that others wrote, read without running anything: no text costs more time than its length.

Only what a tree of plain values needs is taken: strings, decimal numbers, True, False, None, and brackets.
"""

from __future__ import annotations

import ast
import re

from ..messages import message

MOST_CHARACTERS, MOST_DEPTH, MOST_DIGITS = 200_000, 16, 40
_ESCAPE = r"""\\(?:[\\'"abfnrtv]|x[0-9a-fA-F]{2}|u[0-9a-fA-F]{4}|U[0-9a-fA-F]{8})"""
_TOKEN = re.compile(
    r"""(?P<space>\s+|\#[^\n]*)
    |(?P<open>[\[({])|(?P<close>[\])}])|(?P<between>[,:])
    |(?P<number>-?[0-9.][0-9.eE]*(?:(?<=[eE])[+-]?[0-9]+)?)
    |(?P<word>True|False|None)\b
    |(?P<string>'(?:[^'\\\n\0]|ESCAPE)*'|"(?:[^"\\\n\0]|ESCAPE)*")""".replace("ESCAPE", _ESCAPE),
    re.VERBOSE,
)


class LiteralError(ValueError):
    """The text is no such literal; says what was found, and where."""


def value_of(text: str) -> object:
    """Raises LiteralError."""
    if len(text) > MOST_CHARACTERS:
        raise LiteralError(message("{found} characters, need at most {most}", found=len(text), most=MOST_CHARACTERS))
    depth = at = 0
    while at < len(text):
        token = _TOKEN.match(text, at)
        if token is None:
            line = text.count("\n", 0, at) + 1
            raise LiteralError(message("line {line} has {found}", line=line, found=repr(text[at : at + 20])))
        depth += (token.lastgroup == "open") - (token.lastgroup == "close")
        if depth > MOST_DEPTH:
            raise LiteralError(message("brackets are more than {most} deep", most=MOST_DEPTH))
        if token.lastgroup == "number" and len(token[0]) > MOST_DIGITS:
            raise LiteralError(message("a number has more than {most} characters", most=MOST_DIGITS))
        at = token.end()
    try:
        return ast.literal_eval(text)
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError) as error:
        raise LiteralError(str(error)) from error
