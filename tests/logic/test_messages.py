"""Messages read as English and translate by their template."""

from __future__ import annotations

import importlib

import pytest

messages = importlib.import_module("addon.messages")

GERMAN = {
    "Bone {name} bends": "Knochen {name} biegt sich",
    "{part}: move it": "{part}: verschieben",
    "Plain": "Schlicht",
}


def _german(text: str) -> str:
    return GERMAN.get(text, text)


@pytest.mark.parametrize("name", ["Arm", "Arm.L", "{odd}", "100 %", ""])
def test_a_message_is_its_english_text_and_translates_by_its_template(name):
    text = messages.message("Bone {name} bends", name=name)
    assert text == f"Bone {name} bends"
    assert messages.translated(text, _german) == f"Knochen {name} biegt sich"


def test_messages_within_messages_are_translated():
    inner = messages.message("Bone {name} bends", name="Arm")
    outer = messages.message("{part}: move it", part=inner)
    assert outer == "Bone Arm bends: move it"
    assert messages.translated(outer, _german) == "Knochen Arm biegt sich: verschieben"


def test_plain_texts_are_translated_whole():
    assert messages.translated("Plain", _german) == "Schlicht"
    assert messages.translated("unknown", _german) == "unknown"


def test_an_error_keeps_its_message():
    text = messages.message("Bone {name} bends", name="Arm")
    assert messages.of_error(ValueError(text)) is text
    assert messages.of_error(ValueError()) == "ValueError()"
