"""The logic of the extension is imported without Blender: `addon` here is a package without its start.

Hypothesis: the same examples on every machine, no clock.
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

from hypothesis import settings

ADDON = Path(__file__).resolve().parents[2] / "addon"

if "addon" not in sys.modules:
    package = ModuleType("addon")
    package.__path__ = [str(ADDON)]
    sys.modules["addon"] = package

settings.register_profile("turgor", derandomize=True, deadline=None, max_examples=25)
settings.load_profile("turgor")
