"""The add-on in other languages: one file each, from the English text to that language."""

from __future__ import annotations

from collections.abc import Mapping

import bpy

from . import german

# By Blender's name of the language. German, in full; others are welcome.
LANGUAGES: Mapping[str, Mapping[str, str]] = {"de_DE": german.TEXTS}

# Blender looks up labels of operators apart from all other texts.
_CONTEXTS = ("*", "Operator")

_OWNER = __package__


def register() -> None:
    tables = {
        language: {(context, text): translation for text, translation in texts.items() for context in _CONTEXTS}
        for language, texts in LANGUAGES.items()
    }
    bpy.app.translations.register(_OWNER, tables)


def unregister() -> None:
    bpy.app.translations.unregister(_OWNER)
