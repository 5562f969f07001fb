"""Presets of joints: Blender's preset files, the user's own and the shipped ones."""

from __future__ import annotations

import importlib
from pathlib import Path

import bpy
import numpy as np
import pytest
from measure import positions, relative_error, volume
from test_exact import VOLUME_TOLERANCE
from tube import add_turgor, character

FRAME = 15
SHIPPED = sorted((Path(__file__).resolve().parents[2] / "addon" / "presets" / "turgor" / "joint").glob("*.py"))


def _shown(ob: bpy.types.Object) -> np.ndarray:
    bpy.context.view_layer.update()
    bpy.context.scene.frame_set(FRAME)
    return positions(ob)


def _choose(ob: bpy.types.Object, name: str) -> bpy.types.PropertyGroup:
    ob.turgor.active_joint = ob.turgor.joints.find(name)
    return ob.turgor.joints[name]


@pytest.fixture
def presets():
    return importlib.import_module("addon.live.joint_presets")


def _edit(ob: bpy.types.Object, joint: bpy.types.PropertyGroup) -> None:
    """Something of everything: two sets, a curve drawn by hand, directions."""
    joint.preset, joint.strength, joint.size = "MUSCLE", 0.8, 1.4
    joint.use_auto_shares, joint.shares = False, (0.5, 0.2, 0.3)
    joint.preset = "CUSTOM"
    joint.blend_mode, joint.blend = "VALUE", 0.4
    joint.second.preset = "RUBBER"
    joint.second.preset = "CUSTOM"
    bpy.context.view_layer.update()
    mapping = ob.turgor.curves.nodes[joint.curve_along].mapping
    mapping.curves[0].points[1].location.y = 0.35
    mapping.update()
    ob.turgor.curves.update_tag()


def test_a_preset_gives_another_character_the_same_shape(presets):
    ob, _ = character()
    add_turgor(ob)
    _edit(ob, _choose(ob, "Bone1"))
    edited = _shown(ob)
    text = presets.text_of(ob.turgor.joints["Bone1"])
    bpy.data.objects.remove(ob)
    other, _ = character()
    add_turgor(other)
    plain = _shown(other)
    presets.apply(text, [_choose(other, "Bone1")])
    assert (plain != edited).any()
    np.testing.assert_allclose(_shown(other), edited, rtol=0.0, atol=1e-6)
    assert presets.text_of(other.turgor.joints["Bone1"]) == text


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_presets_are_exact(route, path: Path):
    ob, _ = character(rings=61)
    rest = volume(ob)
    add_turgor(ob)
    plain = _shown(ob)
    _choose(ob, "Bone1")
    assert bpy.ops.object.turgor_joint_preset(filepath=str(path)) == {"FINISHED"}
    assert (_shown(ob) != plain).any()
    assert relative_error(ob, rest) < VOLUME_TOLERANCE


def test_selected_joints_get_the_preset_too():
    ob, _ = character()
    add_turgor(ob)
    _choose(ob, "Bone1")
    ob.turgor.joints["Bone2"].select = True
    bpy.ops.object.turgor_joint_preset(filepath=str(SHIPPED[0]))
    assert ob.turgor.joints["Bone1"].preset == ob.turgor.joints["Bone2"].preset == "CUSTOM"


@pytest.mark.parametrize("content", ["", "{'turgor_joint': 1}", "import os", None])
def test_a_broken_preset_changes_nothing(tmp_path: Path, content: str | None, presets):
    ob, _ = character()
    add_turgor(ob)
    joint = _choose(ob, "Bone1")
    _edit(ob, joint)
    before = presets.text_of(joint)
    path = tmp_path / "broken.py"
    if content is not None:
        path.write_text(content)
    with pytest.raises(RuntimeError):
        bpy.ops.object.turgor_joint_preset(filepath=str(path))
    assert presets.text_of(joint) == before


def test_an_unknown_word_changes_nothing(presets):
    ob, _ = character()
    add_turgor(ob)
    joint = _choose(ob, "Bone1")
    joint.preset = "MUSCLE"
    before = presets.text_of(joint)
    with pytest.raises(ValueError, match="FUR"):
        presets.apply(before.replace("'MUSCLE'", "'FUR'"), [joint])
    assert presets.text_of(joint) == before


def test_own_presets_are_kept_found_and_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, presets):
    monkeypatch.setattr(bpy.utils, "user_resource", lambda *_, path="", **__: _folder(tmp_path / path))
    monkeypatch.setattr(bpy.utils, "preset_paths", lambda subdir: [str(tmp_path / "presets" / subdir)])
    ob, _ = character()
    add_turgor(ob)
    _edit(ob, _choose(ob, "Bone1"))
    assert bpy.ops.object.turgor_joint_preset_add(name="My Arm") == {"FINISHED"}
    path = tmp_path / "presets" / "turgor" / "joint" / "My_Arm.py"
    assert path.read_text() == presets.text_of(ob.turgor.joints["Bone1"])
    assert bpy.ops.object.turgor_joint_preset_add(name="My Arm", remove_name=True) == {"FINISHED"}
    assert not path.exists()


def test_shipped_presets_are_not_removed():
    ob, _ = character()
    add_turgor(ob)
    _choose(ob, "Bone1")
    bpy.ops.object.turgor_joint_preset_add(name=SHIPPED[0].stem, remove_name=True)
    assert SHIPPED[0].exists()


def _folder(path: Path) -> str:
    path.mkdir(parents=True, exist_ok=True)
    return str(path)


def test_an_asset_gives_another_file_the_same_shape(tmp_path: Path, presets):
    ob, _ = character()
    add_turgor(ob)
    _edit(ob, _choose(ob, "Bone1"))
    text = presets.text_of(ob.turgor.joints["Bone1"])
    assert bpy.ops.object.turgor_joint_asset_add(name="Arm") == {"FINISHED"}
    tree = bpy.data.node_groups["Arm"]
    assert tree.asset_data is not None
    assert "Turgor" in tree.asset_data.tags
    assert tuple(tree.preview.image_size) == (128, 128)
    path = str(tmp_path / "assets.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    other, _ = character()
    add_turgor(other)
    _choose(other, "Bone1")
    assert bpy.ops.object.turgor_joint_asset_apply(filepath=path, asset="Arm") == {"FINISHED"}
    assert presets.text_of(other.turgor.joints["Bone1"]) == text
    assert "Arm" not in bpy.data.node_groups


@pytest.mark.parametrize("asset", ["Plain", "Missing"])
def test_an_asset_of_another_kind_changes_nothing(asset: str, presets):
    ob, _ = character()
    add_turgor(ob)
    joint = _choose(ob, "Bone1")
    before = presets.text_of(joint)
    bpy.data.node_groups.new("Plain", "ShaderNodeTree").asset_mark()
    with pytest.raises(RuntimeError, match="no joint of Turgor"):
        bpy.ops.object.turgor_joint_asset_apply(asset=asset)
    assert presets.text_of(joint) == before
