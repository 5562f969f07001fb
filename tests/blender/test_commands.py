"""The command line: exit codes, figures for programs, the same bytes from any worker."""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
from body import add_spine
from measure import mesh_positions, positions
from tube import LAST_FRAME, act_locally, add_turgor, character, volume_modifier

FINE, OFF, USAGE, FAILED = range(4)
REPOSITORY = Path(__file__).resolve().parents[2]
# Percent; the engine's figures are float64.
NOTHING = 1e-9


@pytest.fixture
def run(addon, tmp_path):
    """Runs a command: exit code, and what it says to programs."""
    command_line = importlib.import_module("addon.commands.command_line")

    def of(*arguments: object) -> tuple[int, dict]:
        path = tmp_path / "figures.json"
        path.unlink(missing_ok=True)
        code = command_line.main([*map(str, arguments), "--json", str(path)])
        return code, json.loads(path.read_text()) if path.is_file() else {}

    return of


@pytest.fixture
def saved(addon, tmp_path) -> Path:
    """A file with a character."""
    ob, _ = character()
    add_turgor(ob)
    path = tmp_path / "saved.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def test_every_command_says_what_it_takes(addon, capsys):
    command_line = importlib.import_module("addon.commands.command_line")
    for words in ([], ["check"], ["report"], ["bake"], ["verify"], ["export"], ["refine"]):
        assert command_line.main([*words, "--help"]) == FINE
        assert "usage: turgor" in capsys.readouterr().out
    for wrong in (
        [],
        ["bogus"],
        ["report", "--frames", "9-1"],
        ["bake", "--part", "3/2"],
        ["refine", "--threshold", "2"],
    ):
        assert command_line.main(wrong) == USAGE


def test_the_module_knows_every_command(addon):
    command_line = importlib.import_module("addon.commands.command_line")
    module = importlib.import_module("turgor.blender")
    assert tuple(each.NAME for each in command_line.COMMANDS) == module.COMMANDS


def test_check_is_fine_until_something_is_off(route, saved, run):
    code, found = run("check")
    assert code == FINE
    assert found["is_fine"]
    assert found["route"] == route
    assert [each["name"] for each in found["objects"]] == ["Tube"]
    volume_modifier(bpy.data.objects["Tube"]).show_render = False
    code, found = run("check")
    assert code == OFF
    (only,) = [each for each in found["objects"][0]["findings"] if each["severity"] != "INFO"]
    assert only["id"] == "off_in_renders"
    assert only["frame"] is None


def test_check_finds_what_is_missing_on_a_machine(saved, run, tmp_path):
    assert run("bake", "--method", "point-cache", "--save", tmp_path / "out" / "baked.blend")[0] == FINE
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "out" / "baked.blend"))
    assert run("check")[0] == FINE
    (tmp_path / "turgor_bake" / "Tube.pc2").unlink()
    code, found = run("check")
    assert code == OFF
    assert [each["id"] for each in found["findings"]] == ["missing_point_cache"]


def test_report_has_every_frame_with_and_without(saved, run):
    bpy.context.scene.frame_set(5)
    code, found = run("report", "--frames", f"1-{LAST_FRAME}x2", "--tolerance", "1e-4")
    (entry,) = found["objects"]
    assert code == FINE
    assert entry["frames"] == list(range(1, LAST_FRAME + 1, 2))
    assert np.abs(entry["with_turgor"]).max() < NOTHING
    assert np.abs(entry["without_turgor"]).max() > 1.0
    assert bpy.context.scene.frame_current == 5
    _, alone = run("report", "--frames", "15")
    assert alone["objects"][0]["without_turgor"] == [entry["without_turgor"][7]]
    bpy.data.objects["Tube"].turgor.joints[1].strength = 0.0
    code, _ = run("report", "--tolerance", "0.1")
    assert code == OFF


def test_report_of_a_spine(addon, run):
    ob, rig = character()
    ob.modifiers.clear()
    add_spine(ob, rig)
    code, found = run("report", "--frames", "1-10x3")
    (entry,) = found["objects"]
    assert code == FINE
    assert entry["modifier"] == "SPINE"
    assert len(entry["with_turgor"]) == 4
    assert entry["largest_deviation"] < 1.0


@pytest.mark.parametrize("method", ["absolute", "corrective", "reduced", "point-cache"])
def test_what_is_baked_is_verified_in_a_file_of_its_own(saved, run, tmp_path, method: str):
    before = saved.read_bytes()
    target = tmp_path / "elsewhere" / "baked.blend"
    code, found = run("bake", "--method", method, "--error", "0.01", "--frames", "3-17x2", "--save", target)
    assert code == FINE
    assert found["objects"][0]["max_error_relative"] <= 1e-4
    assert saved.read_bytes() == before
    assert run("bake", "--save", saved)[0] == FAILED
    bpy.ops.wm.open_mainfile(filepath=str(target))
    live = bpy.data.objects["Tube"]
    assert live.hide_render
    assert not bpy.data.objects["Tube Baked"].hide_render
    error = "0.01" if method == "reduced" else "0.0001"
    assert run("verify", "--error", error)[0] == FINE
    parts = [run("verify", "--error", error, "--part", f"{part}/3")[1] for part in (1, 2, 3)]
    assert [part["objects"][0]["frames"] for part in parts] == ["3,5", "7-11x2", "13-17x2"]
    assert run("verify", "--frames", "3-17", "--error", "1e-6")[0] == OFF
    assert run("bake", "--save", tmp_path / "again.blend")[0] == FAILED


def _bytes(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.rglob("*") if path.suffix in {".npy", ".pc2"}}


def test_parts_are_the_same_bytes_from_any_worker(saved, run, tmp_path):
    """Whoever computes a chunk, in whatever order: chunks, the cache and the figures are the same."""
    common = ("bake", "--method", "point-cache", "--chunk-frames", "3")
    expected = tmp_path / "one"
    assert run(*common, "--output", expected, "--part", "1/1")[0] == FINE
    chunks = _bytes(expected / ".Tube.chunks")
    assert len(chunks) == -(-LAST_FRAME // 3)
    many = tmp_path / "many"
    for part in (4, 2, 1, 3):
        bpy.ops.wm.open_mainfile(filepath=str(saved))
        bpy.context.scene.frame_set(part)
        code, found = run(*common, "--output", many, "--part", f"{part}/4")
        assert code == FINE
        assert found["objects"][0]["chunk_count"] == len(chunks)
    assert _bytes(many / ".Tube.chunks") == chunks
    figures = []
    for folder in (expected, many):
        bpy.ops.wm.open_mainfile(filepath=str(saved))
        figures.append(run(*common, "--output", folder))
    assert figures[0] == figures[1]
    assert figures[0][0] == FINE
    assert json.loads((many / "Tube_point_cache.json").read_text())["resumed_chunks"] == len(chunks)
    assert _bytes(expected) == _bytes(many)


def test_refined_characters_go_into_another_file(saved, run, tmp_path):
    """What the panel says counts where nothing is given; the same figures and places from any run."""
    path = tmp_path / "new folder" / "refined.blend"
    mesh = bpy.data.objects["Tube"].data
    act_locally(bpy.data.objects["Tube"])
    bpy.ops.wm.save_mainfile()
    before, content = len(mesh.vertices), saved.read_bytes()
    bpy.data.objects["Tube"].turgor.refine.threshold = 1.0
    code, found = run("refine")
    assert code == FINE
    assert found["objects"][0]["refined_faces"] == 0
    given = ("--threshold", "0.1", "--levels", "1", "--no-automatic", "--method", "smooth")
    code, found = run("refine", *given, "--save", path)
    (entry,) = found["objects"]
    assert code == FINE
    assert 0 < entry["refined_faces"] < entry["faces"]
    assert entry["vertices"] == before < entry["vertices_afterwards"] == len(mesh.vertices)
    refined = mesh_positions(mesh)
    assert saved.read_bytes() == content
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert np.array_equal(mesh_positions(bpy.data.objects["Tube"].data), refined)
    assert run("check")[0] == FINE
    assert run("report", "--tolerance", "1e-4")[0] == FINE
    bpy.ops.wm.open_mainfile(filepath=str(saved))
    assert run("refine", *given) == (FINE, found)
    assert np.array_equal(mesh_positions(bpy.data.objects["Tube"].data), refined)
    bpy.ops.wm.open_mainfile(filepath=str(saved))
    _, automatic = run("refine", "--threshold", "0.1", "--levels", "1", "--automatic")
    assert automatic["objects"][0]["vertices_afterwards"] < entry["vertices_afterwards"]


def test_a_linked_mesh_is_refined_in_its_own_file(saved, run, tmp_path, capsys):
    path = str(tmp_path / "mesh.blend")
    ob = bpy.data.objects["Tube"]
    bpy.data.libraries.write(path, {ob.data})
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.meshes = [ob.data.name]
    ob.data = wanted.meshes[0]
    assert run("refine")[0] == FAILED
    assert "Tube: The mesh is linked: refine it in its own file" in capsys.readouterr().err


def test_refusals_say_what_to_do(saved, run, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    for arguments, words in (
        (("check", "--object", "Nobody"), "Nobody; the file has Tube"),
        (("bake",), "--save FILE"),
        (("bake", "--save", tmp_path / "x.txt"), ".blend"),
        (("bake", "--save", tmp_path / "x.blend", "--output", tmp_path / "file"), "is a file"),
        (("verify",), "bake with --save first"),
        (("refine", "--save", saved), "is the file that is open"),
    ):
        assert run(*arguments)[0] == FAILED
        assert words in capsys.readouterr().err


def test_files_of_the_command_line_show_what_was_live(saved, run, tmp_path):
    bpy.context.scene.frame_set(12)
    expected = positions(bpy.data.objects["Tube"])
    assert run("bake", "--save", tmp_path / "baked.blend")[0] == FINE
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "baked.blend"))
    bpy.context.scene.frame_set(12)
    assert np.abs(positions(bpy.data.objects["Tube Baked"]) - expected).max() < 1e-6


@pytest.mark.parametrize("suffix", ["glb", "fbx", "usdc", "abc"])
def test_exports_are_read_again_and_compared(saved, run, tmp_path, suffix: str):
    path = tmp_path / "new folder" / f"file.{suffix}"
    code, found = run("export", path, "--frames", "2-19", "--error", "0.005")
    assert code == FINE
    assert path.is_file()
    (verified,) = found["verified"]
    assert verified["max_error_relative"] < 1e-4
    assert verified["volume_error_relative"] < 1e-4
    bpy.ops.wm.open_mainfile(filepath=str(saved))
    bpy.data.objects["Tube"].data.name = "Other.Name"
    has_keys = suffix in {"glb", "fbx"}
    assert run("export", path, "--error", "0.5", "--tolerance", "1e-7")[0] == (OFF if has_keys else FINE)
    if has_keys:
        bpy.ops.wm.open_mainfile(filepath=str(saved))
        assert run("export", path, "--error", "0.5", "--volume-tolerance", "1e-7")[0] == OFF
    bpy.ops.wm.open_mainfile(filepath=str(saved))
    assert run("export", tmp_path / "file.obj")[0] == FAILED


def _archive() -> Path:
    archives = sorted((REPOSITORY / "dist").glob("turgor-*.zip"))
    if not archives:
        pytest.skip("no zip in dist/: run `make package`")
    return archives[-1]


def test_module_runs_commands_with_a_zip_and_leaves_the_machine_alone(saved, tmp_path):
    """`python -m turgor.blender`, in a Blender that has no extension."""
    home = tmp_path / "home"
    home.mkdir()
    environment = os.environ | {"BLENDER_USER_RESOURCES": str(home)}
    command = [sys.executable, "-m", "turgor.blender", str(saved)]

    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([*command, *arguments], env=environment, capture_output=True, text=True, check=False)

    without = run("check")
    assert without.returncode == FAILED
    assert "no Turgor extension is installed" in without.stderr
    done = run("--extension", str(_archive()), "check", "--json", str(tmp_path / "check.json"))
    assert done.returncode == FINE, done.stdout + done.stderr
    assert json.loads((tmp_path / "check.json").read_text())["objects"][0]["name"] == "Tube"
    assert run("bogus").returncode == USAGE
    assert not any(home.rglob("blender_manifest.toml"))
