"""Presets as text: what is written reads back equal, what is broken says so, nothing is run."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

joint_preset = importlib.import_module("addon.logic.joint_preset")
SHIPPED = sorted((Path(__file__).resolve().parents[2] / "addon" / "presets" / "turgor" / "joint").glob("*.py"))

unit = st.floats(0.0, 1.0)
points = st.lists(st.tuples(unit, unit, st.sampled_from(["AUTO", "VECTOR"])), min_size=2, max_size=5).map(tuple)
curve = st.builds(joint_preset.Curve, st.booleans(), points)
profiles = st.builds(
    joint_preset.Profiles,
    st.sampled_from(["MUSCLE", "CUSTOM"]),
    st.sampled_from(["MUSCLE", "FOLDS"]),
    st.booleans(),
    st.tuples(unit, unit, unit),
    st.one_of(st.just(()), st.tuples(curve, curve, curve)),
)
positive = st.floats(0.0, 1e6)
presets = st.builds(
    joint_preset.JointPreset,
    positive,
    positive,
    positive,
    st.sampled_from(["NONE", "LOSS"]),
    unit,
    positive,
    unit,
    st.booleans(),
    unit,
    unit,
    unit,
    profiles,
    profiles,
)


@given(presets)
def test_what_is_written_reads_back_equal(preset):
    assert joint_preset.from_text(joint_preset.to_text(preset)) == preset


@given(presets)
def test_presets_of_before_follow_flesh_as_new_joints_do(preset):
    fields = joint_preset.value_of(joint_preset.to_text(preset))
    for name in ("flex", "flesh", "use_auto_outside", "outside", "spread_twist", "crease"):
        del fields[name]
    of_new = {"flex": 0.0, "flesh": 1.0, "use_auto_outside": True, "outside": 1.0, "spread_twist": 1.0, "crease": 0.7}
    expected = preset._replace(**of_new)
    assert joint_preset.from_text(repr(fields)) == expected


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_presets_read(path: Path):
    text = path.read_text(encoding="utf-8")
    assert text.startswith(joint_preset.FIRST_LINE)
    preset = joint_preset.from_text(text)
    assert joint_preset.from_text(joint_preset.to_text(preset)) == preset


def test_presets_are_shipped():
    assert SHIPPED


GOOD = joint_preset.to_text(
    joint_preset.JointPreset(
        1.0,
        1.0,
        0.0,
        "NONE",
        0.0,
        0.1,
        1.0,
        True,
        1.0,
        1.0,
        1.0,
        joint_preset.Profiles("MUSCLE", "MUSCLE", True, (0.0, 0.0, 1.0), ()),
        joint_preset.Profiles("MUSCLE", "MUSCLE", True, (0.0, 0.0, 1.0), ()),
    )
)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "Not a joint preset"),
        ("{", "Not a joint preset"),
        ("[1, 2]", "Not a joint preset"),
        ("__import__('os').getcwd()", "Not a joint preset"),
        ("{'turgor_joint': 99}", "format 99"),
        ("{'turgor_joint': 'x' 'y'}", "format 'xy'"),
        ("{{}: 1}", "unhashable"),
        ("{[]: 1}", "unhashable"),
        ("{1, {}}", "unhashable"),
        ("{'turgor_joint': [1]}", r"format \[1\]"),
        ("(" * 100_000, "16 deep"),
        ("[" * 200 + "]" * 200, "16 deep"),
        ("-" * 3000 + "1", "line 1 has '-"),
        ("9**9**9", r"line 1 has '\*\*9"),
        ("'a'*10**10", r"line 1 has '\*10"),
        ("a" + ".a" * 50_000, "line 1 has 'a.a"),
        ("{'turgor_joint': 1, 'strength': " + "9" * 5000 + "}", "a number has more than"),
        ("{'turgor_joint': 1, 'strength': 1e400}", "strength"),
        ("\n\n\0", "line 3 has"),
        ("'\ud800'", "Not a joint preset"),
        ("#" * 300_000, "300000 characters"),
        ("{'turgor_joint': 1, 'strength': 1.0, 'size': 1.0, 'blend_mode': 'A', 'blend': 0, 'fold_loss': 0}", "first"),
        (GOOD.replace("'strength': 1.0", "'strength': -1.0"), "strength"),
        (GOOD.replace("'strength': 1.0", "'strength': 1e999"), "strength"),
        (GOOD.replace("'strength': 1.0", "'strength': 'much'"), "strength"),
        (GOOD.replace("'blend_mode': 'NONE'", "'blend_mode': 3"), "blend_mode"),
        (GOOD.replace("'curves': []", "'curves': [1]"), "curves"),
        (GOOD.replace("(0.0, 0.0, 1.0)", "(0.0, 2.0)"), "shares"),
        (GOOD.replace("(0.0, 0.0, 1.0)", "(0.0, 0.0, 2.0)"), "share"),
    ],
)
def test_what_is_broken_says_so(text: str, told: str):
    with pytest.raises(joint_preset.PresetError, match=told):
        joint_preset.from_text(text)


words = st.sampled_from(
    [
        *"[](){},:'\"\\#-+*.~@=\n\t\0 ",
        "{[]: 1}",
        "turgor_joint",
        "'first'",
        "1e999",
        "not ",
        "lambda:",
        "0x",
        "1_0",
        "9" * 50,
    ]
)
texts = st.one_of(
    st.text(max_size=80),
    st.lists(words, max_size=40).map("".join),
    st.tuples(words, st.integers(1, 5000)).map(lambda pair: pair[0] * pair[1]),
    st.tuples(st.integers(0, len(GOOD)), st.integers(0, 60), st.lists(words, max_size=4)).map(
        lambda cut: GOOD[: cut[0]] + "".join(cut[2]) + GOOD[cut[0] + cut[1] :]
    ),
    st.recursive(
        st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5)),
        lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(st.text(max_size=8), inner, max_size=4)),
    ).map(lambda value: repr({"turgor_joint": 1, "strength": 1.0, "size": 1.0, "first": value, "blend_mode": value})),
)


@settings(max_examples=500)
@given(texts)
def test_any_text_is_a_preset_or_refused(text: str):
    try:
        preset = joint_preset.from_text(text)
    except joint_preset.PresetError:
        return
    assert joint_preset.from_text(joint_preset.to_text(preset)) == preset
