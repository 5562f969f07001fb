"""Files of bakes: one set for each character, and nobody else's are overwritten without a word."""

from __future__ import annotations

import importlib
import json
from pathlib import Path

import bpy
import numpy as np
import pytest
from tube import LAST_FRAME, add_turgor, character, place, tube_mesh

FRAMES = np.arange(1.0, 7.0)
FINE, FAILED = 0, 3


@pytest.fixture
def bake(addon, tmp_path):
    job, options = importlib.import_module("addon.bake.job"), importlib.import_module("addon.bake.options")

    def run(ob, method="POINT_CACHE", frames=FRAMES, **chosen):
        given = {"folder": tmp_path / "bakes", "name": "Baked"} | chosen
        made = job.Job(ob, options.Options(method, frames, **given))
        list(made.run())
        return made

    return run


def _contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def _saved(path: Path, turn: float = 1.0, name: str = "Tube") -> Path:
    """A file with a character of that name."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    ob, armature = character()
    ob.name = name
    armature.pose.bones["Bone1"].rotation_euler.x = turn
    armature.pose.bones["Bone1"].keyframe_insert("rotation_euler", frame=LAST_FRAME)
    add_turgor(ob)
    path.parent.mkdir(exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.mark.parametrize(
    "names", [("A b", "A_b"), ("A/b", "A_b"), ("Tube.001", "Tube.002"), ("Body", "body"), ("é", "e\u0301")]
)
def test_two_characters_have_two_of_each_file(bake, tmp_path, names: tuple[str, str]):
    one, armature = character()
    other = place("Other", tube_mesh("Other", at_x=2.0, rings=25), armature)
    one.name, other.name = names
    add_turgor(one)
    add_turgor(other)
    for method in ("POINT_CACHE", "REDUCED"):
        made = [bake(ob, method, tolerance=0.01) for ob in (one, other)]
        assert all(each.report.max_error <= 0.01 for each in made)
    caches = [
        bpy.path.abspath(each.modifiers["Mesh Cache"].filepath)
        for each in bpy.data.objects
        if "Mesh Cache" in each.modifiers
    ]
    assert len({path.casefold() for path in caches}) == 2
    assert len({path.name.casefold() for path in (tmp_path / "bakes").iterdir()}) == 2 * (1 + 4)


def test_linked_characters_of_one_name_have_their_own(bake, tmp_path):
    libraries = [_saved(tmp_path / f"{name}.blend", turn) for name, turn in (("one", 0.4), ("two", 1.3))]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for path in libraries:
        with bpy.data.libraries.load(str(path), link=True) as (_, wanted):
            wanted.objects = ["Tube", "Rig"]
        for ob in wanted.objects:
            bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.update()
    importlib.import_module("addon.live.start").bind_waiting()
    linked = [ob for ob in bpy.data.objects if ob.name == "Tube" and ob.library is not None]
    made = [bake(ob, frames=np.arange(1.0, LAST_FRAME + 1.0)) for ob in linked]
    assert len(made) == 2
    contents = _contents(tmp_path / "bakes")
    caches = {content for name, content in contents.items() if name.endswith(".pc2")}
    assert len(caches) == 2
    assert len(contents) == 6
    assert "Tube.pc2" not in contents
    assert all(each.report.max_error <= 1e-6 * each.report.size for each in made)


@pytest.mark.parametrize("method", ["POINT_CACHE", "REDUCED"])
def test_another_files_bake_is_not_overwritten(bake, tmp_path, method: str):
    """Nor that of another scene; the own one is, and so is that of a copy of the same file somewhere else."""
    _saved(tmp_path / "one.blend", 0.4)
    bake(bpy.data.objects["Tube"], method, tolerance=0.01)
    before = _contents(tmp_path / "bakes")
    bake(bpy.data.objects["Tube"], method, tolerance=0.01)
    _saved(tmp_path / "two.blend", 1.3)
    files = importlib.import_module("addon.logic.bake_files")
    with pytest.raises(files.OccupiedError, match=r"Tube, scene Scene of \.\./one\.blend.*another folder"):
        bake(bpy.data.objects["Tube"], method, tolerance=0.01)
    assert _contents(tmp_path / "bakes").keys() == before.keys()
    assert json.loads(before[f"Tube_{method.lower()}.json"])["source"]["file"] == "../one.blend"
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "copy.blend").write_bytes((tmp_path / "one.blend").read_bytes())
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "elsewhere" / "copy.blend"))
    bake(bpy.data.objects["Tube"], method, tolerance=0.01)
    bpy.context.scene.name = "Another"
    before = _contents(tmp_path / "bakes")
    with pytest.raises(files.OccupiedError, match="scene Scene of"):
        bake(bpy.data.objects["Tube"], method, tolerance=0.01)
    assert _contents(tmp_path / "bakes") == before
    assert not list((tmp_path / "bakes").glob(".*"))
    made = bake(bpy.data.objects["Tube"], method, tolerance=0.01, overwrite=True)
    assert made.report.source.scene == "Another"


@pytest.mark.parametrize("name", ["Tube.pc2", "Tube_point_cache.json", "Tube_point_cache.txt"])
@pytest.mark.parametrize(
    "content", [b"", b"somebody's", b"[]", b'{"source": 3}', b'{"source": {"file": 1}}', b"\xff" * 9]
)
def test_files_of_unknown_origin_stay(bake, tmp_path, name: str, content: bytes):
    ob, _ = character()
    add_turgor(ob)
    (tmp_path / "bakes").mkdir()
    (tmp_path / "bakes" / name).write_bytes(content)
    with pytest.raises(ValueError, match="unknown origin, and would be overwritten by Tube, scene Scene"):
        bake(ob)
    assert _contents(tmp_path / "bakes") == {name: content}
    assert "Baked" not in bpy.data.objects


def test_a_file_that_comes_while_a_bake_runs_stays(addon, tmp_path):
    ob, _ = character()
    add_turgor(ob)
    job, options = importlib.import_module("addon.bake.job"), importlib.import_module("addon.bake.options")
    made = job.Job(ob, options.Options("POINT_CACHE", FRAMES, folder=tmp_path, name="Baked"))
    steps = made.run()
    next(steps)
    (tmp_path / "Tube.pc2").write_bytes(b"somebody's")
    with pytest.raises(ValueError, match="unknown origin"):
        list(steps)
    assert (tmp_path / "Tube.pc2").read_bytes() == b"somebody's"
    assert "Baked" not in bpy.data.objects
    assert made.chunk_folder.is_dir()


def test_other_settings_of_the_same_character_are_told(bake):
    ob, _ = character()
    add_turgor(ob)
    assert not bake(ob).report.notes
    assert not bake(ob).report.notes
    made = bake(ob, frames=np.arange(1.0, 5.0))
    assert made.report.notes == [
        "Tube_point_cache.json was of a bake of frames 1-6 with other settings, and was replaced"
    ]


def test_files_without_a_name_are_told_from_each_other(bake):
    ob, _ = character()
    add_turgor(ob)
    bake(ob)
    bake(ob)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    ob, _ = character()
    add_turgor(ob)
    with pytest.raises(ValueError, match="a file without a name"):
        bake(ob)


def test_the_command_overwrites_only_where_it_is_told(addon, tmp_path, capsys):
    command_line = importlib.import_module("addon.commands.command_line")
    for name in ("one", "two"):
        _saved(tmp_path / f"{name}.blend", 0.5 * len(name))
        words = [
            "bake",
            "--method",
            "point-cache",
            "--output",
            str(tmp_path / "bakes"),
            "--save",
            str(tmp_path / f"{name}_b.blend"),
        ]
        code = command_line.main(words)
        assert code == (FINE if name == "one" else FAILED)
    assert "Tube.pc2" in (said := capsys.readouterr().err) or "Tube_point_cache" in said
    assert command_line.main([*words[:5], "--part", "1/2"]) == FAILED
    assert command_line.main([*words, "--overwrite"]) == FINE
    assert not list((tmp_path / "bakes").glob(".*"))
