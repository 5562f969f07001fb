"""The lines that `make mutants` breaks are still there, and so are the tests that are to notice."""

from __future__ import annotations

import pytest
from sources import REPOSITORY

from tests.mutation.broken_lines import BROKEN_LINES, BrokenLine


@pytest.mark.parametrize("line", BROKEN_LINES, ids=lambda line: f"{line.path}: {line.before.strip()[:40]}")
def test_a_broken_line_stands_once(line: BrokenLine):
    assert (REPOSITORY / line.path).read_text(encoding="utf-8").count(line.before) == 1
    assert line.after != line.before
    assert all((REPOSITORY / test).is_file() for test in line.tests)
