"""Every text of the interface exists in every language."""

from __future__ import annotations

import importlib
import string

import pytest
import ui_texts

# Signs that are the same in every language.
SIGNS = set("–%XYZ")


@pytest.fixture
def languages():
    return importlib.import_module("addon.translations").LANGUAGES


def test_every_text_is_translated(languages):
    texts = dict.fromkeys(ui_texts.of_classes("addon"), "a class")
    texts |= {text: place for place, text in ui_texts.in_sources() if text is not None}
    for language, known in languages.items():
        missing = {
            text: place for text, place in texts.items() if text and not set(text) <= SIGNS and text not in known
        }
        assert not missing, language


def test_what_shows_words_can_be_translated():
    """A sentence put together in the source is a template, `messages.message` or `iface_("...").format`."""
    assert [place for place, text in ui_texts.in_sources() if text is None] == []


def test_translations_have_the_same_values(languages):
    def values(text: str) -> set[tuple[str | None, str | None]]:
        return {(name, form) for _, name, form, _ in string.Formatter().parse(text) if name is not None}

    for known in languages.values():
        assert [text for text, other in known.items() if "{" in text and values(text) != values(other)] == []


def test_no_translation_is_empty(languages):
    for known in languages.values():
        assert all(text.strip() and other.strip() for text, other in known.items())
