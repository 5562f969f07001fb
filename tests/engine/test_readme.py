"""The example of the README runs and keeps the volume."""

from __future__ import annotations

from pathlib import Path

import pytest

README = Path(__file__).resolve().parents[2] / "README.md"


def test_example(capsys: pytest.CaptureFixture[str]):
    (example,) = README.read_text(encoding="utf-8").split("```python\n")[1:]
    exec(example.partition("```")[0], {})
    rest, skinned, corrected = (float(word) for word in capsys.readouterr().out.split())
    assert skinned < 0.99 * rest
    assert corrected == pytest.approx(rest, rel=1e-12)
