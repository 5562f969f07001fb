"""A bake that is killed, at whatever moment, loses one chunk at most, and ends with the bytes of one that was not.

TURGOR_KILLS=20 kills each kind of bake so often; -s shows what came of each kill.
"""

from __future__ import annotations

import importlib
import os
import random
import shutil
import signal

import bpy
import pytest
from killed_bakes import CHUNKS, METHODS, STAGES, finished, kill, options, result
from tube import add_turgor, character

# The stages that are killed are dealt in this order; two kills see the comparison with the live character too.
ORDER = ("sampling", "live", "making", "ending", "comparing")
KILLS = int(os.environ.get("TURGOR_KILLS", "2"))


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no kill -9 on this system")
@pytest.mark.parametrize("method", METHODS)
def test_a_killed_bake_loses_one_chunk_at_most(addon, tmp_path, method: str):
    assert set(ORDER) == set(STAGES)
    ob, _ = character(rings=61, segments=24)
    add_turgor(ob)
    path, folder = tmp_path / "file.blend", tmp_path / "bake"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    saved = path.read_bytes()
    made = importlib.import_module("addon.bake.job").Job(ob, options(method, tmp_path / "undisturbed"))
    list(made.run())
    expected = result(made.baked)
    rng = random.Random(method)
    kills = []
    while len(kills) < KILLS:
        stage = ORDER[len(kills) % len(ORDER)]
        if stage == "sampling":
            shutil.rmtree(folder, ignore_errors=True)
        found = kill(path, folder, method, stage, rng)
        after = "ended before it" if found.is_late else f"{found.kept} after"
        print(f"{method}: killed while {stage}, {found.done} chunks before, {after}")
        if found.is_late:
            # Its chunks may be gone: it has ended.
            shutil.rmtree(folder, ignore_errors=True)
            continue
        kills.append(found)
        assert found.kept >= found.done - 1
    digest, resumed = finished(path, folder, method)
    print(f"{method}: {len(kills)} kills, then {resumed} of {CHUNKS} chunks resumed, same bytes: {digest == expected}")
    assert digest == expected
    assert resumed >= kills[-1].kept - 1
    assert path.read_bytes() == saved
    assert not list(folder.glob(".*.chunks"))
