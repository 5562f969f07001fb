"""Arrays of any layout are read as what they hold, or refused by their names; every array of every call is tried."""

from __future__ import annotations

import ast
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import turgor
from rigs import limb
from spines import helix, line

STUBS = Path(__file__).parents[2] / "rust" / "python" / "turgor" / "_native.pyi"

RIG = limb(bone_count=2, rings=7, sides=6)
SURFACE = RIG.surface
COUNT = len(SURFACE.positions)
MESH = SURFACE.mesh()
POSE = RIG.bent(0.6)
POSES = np.array([POSE, RIG.bent(0.2)])
SHAPES = np.random.default_rng(1).normal(size=(1, COUNT, 3)) * 0.01
SKIN = turgor.VolumeSkin(MESH, RIG.skinning(), shape_deltas=SHAPES)
SPINE = turgor.Spine(line())
STEP = np.array([0.1, 0, 0])
POSED = SPINE.posed(helix())
FLESH = turgor.Fleshing(SPINE, SURFACE.positions)
OBJECT = np.diag([2.0, 2.0, 2.0, 1.0])
CURVE = np.array([0.0, 1.0, 0.5])
HEADS, TAILS = np.array([[0.0, 0, 0], [2, 0, 0]]), np.array([[2.0, 0, 0], [4, 0, 0]])
OFFSETS = np.zeros((COUNT, 3), np.float32)

FRAME = {
    "pose_matrices": POSE,
    "object_from_armature": OBJECT,
    "shape_values": np.array([0.5]),
    "strengths": np.array([1.0, 0.5]),
    "rest_positions": (1.1 * SURFACE.positions).astype(np.float32),
    "added_offsets": np.full((COUNT, 3), 0.01, np.float32),
}
FRAMES = {
    "pose_matrices": POSES,
    "object_from_armature": OBJECT,
    "shape_values": np.array([[0.5], [0.1]]),
    "strengths": np.ones((2, 2)),
    "target_scale": np.array([1.0, 1.1]),
    "rest_positions": np.stack([FRAME["rest_positions"], SURFACE.positions.astype(np.float32)]),
    "added_offsets": np.stack([FRAME["added_offsets"], 2 * FRAME["added_offsets"]]),
}


def joint(**curves) -> turgor.Joint:
    """Curves one by one, three times each: the stubs take them by threes."""
    by_threes: dict[str, Any] = {"profiles": (CURVE,) * 3} | {name: (curve,) * 3 for name, curve in curves.items()}
    return turgor.Joint(0, **by_threes)


def weights(**arrays: Any) -> turgor.Weights:
    """Automatic weights, with the arrays that it takes in tuples."""
    mesh, locked, plane = (
        tuple(arrays.pop(name) for name in names)
        for names in (
            ("positions", "face_offsets", "face_corners"),
            ("weight_offsets", "weight_bones", "weight_numbers"),
            ("point", "normal"),
        )
    )
    return turgor.automatic_weights([mesh], resolution=16, locked_weights=locked, symmetry_plane=plane, **arrays)


def into_address(flesh_or_skin: Any, **arrays) -> np.ndarray:
    """deform_into_address of offsets of our own."""
    offsets = OFFSETS.copy()
    flesh_or_skin.deform_into_address(offsets.ctypes.data, COUNT, **arrays)
    return offsets


def into(flesh_or_skin: Any, **arrays) -> np.ndarray:
    flesh_or_skin.deform_into(arrays["offsets"], **{k: v for k, v in arrays.items() if k != "offsets"})
    return np.array(arrays["offsets"])


def moved(spine: turgor.Spine) -> np.ndarray:
    return spine.evaluate(np.linspace(-1.0, 6.0, 9)).positions


MESH_ARRAYS = {
    "rest_positions": SURFACE.positions,
    "face_offsets": SURFACE.face_offsets,
    "face_corners": SURFACE.face_corners,
}
TWIST = np.linspace(0.0, 1.0, 7)

# Every call that takes arrays: what it makes of them as numbers, and arrays that it takes.
CALLS: dict[str, tuple[Callable[..., Any], dict[str, np.ndarray]]] = {
    "Mesh.__new__": (lambda **a: turgor.Mesh(**a).volume_gradient(SURFACE.positions), MESH_ARRAYS),
    "Mesh.volume": (MESH.volume, {"positions": SURFACE.positions}),
    "Mesh.component_volumes": (MESH.component_volumes, {"positions": SURFACE.positions}),
    "Mesh.volume_gradient": (MESH.volume_gradient, {"positions": SURFACE.positions}),
    "Skeleton.__new__": (
        lambda **a: turgor.Skinning(turgor.Skeleton(**a), [0, 1], [1], [1.0]).deform([[1, 0, 0]], POSE),
        {"parents": np.array([-1, 0], np.int32), "rest_matrices": np.tile(np.eye(4), (2, 1, 1))},
    ),
    "Skinning.__new__": (
        lambda **a: turgor.Skinning(RIG.skeleton(), **a).deform([[1, 0, 0], [2, 0, 0]], POSE),
        {
            "weight_offsets": np.array([0, 1, 2], np.int32),
            "weight_bones": np.array([1, 0], np.int32),
            "weights": np.array([0.5, 1.0]),
            "vertex_mask": np.array([1.0, 0.5]),
        },
    ),
    "Skinning.deform": (
        RIG.skinning().deform,
        {"positions": SURFACE.positions, "pose_matrices": POSE, "object_from_armature": OBJECT},
    ),
    "Joint.__new__": (
        lambda **a: SKIN.with_joints([joint(**a)]).deform(RIG.bent(1.0)).offsets,
        {"profiles": CURVE, "folded_profiles": CURVE[::-1].copy()},
    ),
    "VolumeSkin.__new__": (
        lambda **a: turgor.VolumeSkin(MESH, RIG.skinning(), **a).deform(POSE, shape_values=[0.5]).offsets,
        {"shape_deltas": SHAPES, "object_from_armature": OBJECT},
    ),
    "VolumeSkin.with_mask": (
        lambda **a: SKIN.with_mask(**a).deform(POSE).offsets,
        {"mask": np.linspace(0, 1, COUNT).astype(np.float32)},
    ),
    "VolumeSkin.deform": (lambda **a: SKIN.deform(**a).offsets, FRAME),
    "VolumeSkin.deform_into": (lambda **a: into(SKIN, **a), {"offsets": OFFSETS, **FRAME}),
    "VolumeSkin.deform_into_address": (lambda **a: into_address(SKIN, **a), FRAME),
    "VolumeSkin.joint_field": (lambda **a: SKIN.joint_field(1, **a).gamma, FRAME),
    "VolumeSkin.measure": (lambda **a: SKIN.measure(**a).corrected_volumes, FRAMES),
    "VolumeSkin.deform_many": (
        SKIN.deform_many,
        FRAMES
        | {
            "effect": np.array([1.0, 0.5]),
            "fold_counts": np.zeros((2, 3), np.int32),
            "positions": np.zeros((2, COUNT, 3), np.float32),
        },
    ),
    "VolumeSkin.refinement_need": (
        lambda **a: SKIN.refinement_need(**a).gamma,
        FRAMES,
    ),
    "correct": (
        lambda **a: turgor.correct(MESH, **a),
        {
            "positions": SURFACE.positions,
            "target_volume": MESH.component_volumes(SURFACE.positions) * 1.1,
            "gamma": np.linspace(1, 2, COUNT),
            "frame": np.eye(3),
        },
    ),
    "Spine.__new__": (
        lambda **a: moved(turgor.Spine(**a)),
        {"points": helix(), "parameters": np.arange(7.0), "normal": np.array([0.0, 0, 1])},
    ),
    "Spine.from_bezier": (
        lambda **a: moved(turgor.Spine.from_bezier(**a)),
        {
            "points": helix(),
            "left_handles": helix() - STEP,
            "right_handles": helix() + STEP,
            "normal": np.array([0.0, 0, 1]),
        },
    ),
    "Spine.from_nurbs": (
        lambda **a: moved(turgor.Spine.from_nurbs(**a)),
        {"points": helix(), "weights": np.linspace(1, 2, 7), "normal": np.array([0.0, 0, 1])},
    ),
    "Spine.from_poly": (
        lambda **a: moved(turgor.Spine.from_poly(**a)),
        {"points": helix(), "normal": np.array([0.0, 0, 1])},
    ),
    "Spine.posed": (lambda **a: moved(SPINE.posed(**a)), {"points": helix(), "normal": np.array([0.0, 0, 1])}),
    "Spine.evaluate": (lambda **a: SPINE.evaluate(**a).positions, {"parameters": np.linspace(-1, 6, 9)}),
    "Spine.parameters_at": (SPINE.parameters_at, {"arc_lengths": np.linspace(-1, 6, 9)}),
    "Spine.arc_lengths_at": (SPINE.arc_lengths_at, {"parameters": np.linspace(-1, 6, 9)}),
    "Spine.closest": (lambda **a: SPINE.closest(**a).distances, {"points": SURFACE.positions}),
    "Fleshing.__new__": (
        lambda **a: turgor.Fleshing(SPINE, **a).deform(POSED),
        {"points": SURFACE.positions, "influence": np.linspace(0, 1, COUNT)},
    ),
    "Fleshing.deform": (lambda **a: FLESH.deform(POSED, **a), {"twist": TWIST}),
    "Fleshing.deform_into": (
        lambda **a: into(FLESH, posed_spine=POSED, **a),
        {"offsets": OFFSETS, "twist": TWIST},
    ),
    "Fleshing.deform_into_address": (lambda **a: into_address(FLESH, posed_spine=POSED, **a), {"twist": TWIST}),
    "Fleshing.inverse": (
        lambda **a: FLESH.inverse(posed_spine=POSED, **a),
        {"points": SURFACE.positions, "twist": TWIST},
    ),
    "Fleshing.validity": (lambda **a: FLESH.validity(POSED, **a).usage, {"twist": TWIST}),
    "Fleshing.valid_radii": (lambda **a: FLESH.valid_radii(POSED, **a), {"parameters": np.linspace(0, 4, 5)}),
    "flesh": (
        lambda **a: turgor.flesh(rest_spine=SPINE, posed_spine=POSED, **a),
        {"points": SURFACE.positions, "influence": np.linspace(0, 1, COUNT), "twist": TWIST},
    ),
    "automatic_weights": (
        lambda **a: weights(**a).weights,
        {
            "positions": SURFACE.positions,
            "face_offsets": SURFACE.face_offsets,
            "face_corners": SURFACE.face_corners,
            "bone_heads": HEADS,
            "bone_tails": TAILS,
            "bone_parents": np.array([-1, 0], np.int32),
            "stiffness": np.array([1.0, 2.0]),
            "is_solid": np.array([True]),
            "is_locked": np.array([False, True]),
            "weight_offsets": np.arange(COUNT + 1, dtype=np.int32),
            "weight_bones": np.ones(COUNT, np.int32),
            "weight_numbers": np.linspace(0.0, 0.9, COUNT),
            "point": np.zeros(3),
            "normal": np.array([0.0, 1, 0]),
            "mirrored_bones": np.array([0, 1], np.int32),
        },
    ),
}


def _posed(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Posed positions, which nothing may be added to, in place of added offsets."""
    offsets = arrays["added_offsets"]
    rest = {name: array for name, array in arrays.items() if name != "added_offsets"}
    return rest | {"posed_positions": (SURFACE.positions + offsets).astype(np.float32)}


POSED_SUFFIX = " of posed positions"
CALLS |= {
    call + POSED_SUFFIX: (function, _posed(arrays))
    for call, (function, arrays) in CALLS.items()
    if "added_offsets" in arrays
}

# Arrays that are written, not read.
OUTPUTS = {"offsets", "fold_counts", ("VolumeSkin.deform_many", "positions")}
OUTPUTS |= {("VolumeSkin.deform_many" + POSED_SUFFIX, "positions")}
# What messages call arrays that come in tuples.
TUPLES = {"weight_numbers": "weights", "point": "symmetry_plane", "normal": "symmetry_plane|normal"}
CURVES = {"profiles": "profile", "folded_profiles": "profile|folded_profiles", "positions": "positions|rest_positions"}


def is_output(call: str, name: str) -> bool:
    return name in OUTPUTS or (call, name) in OUTPUTS


INPUTS = [(call, name) for call, (_, arrays) in CALLS.items() for name in arrays if not is_output(call, name)]
WRITTEN = [(call, name) for call, (_, arrays) in CALLS.items() for name in arrays if is_output(call, name)]


def misaligned(array: np.ndarray) -> np.ndarray:
    """The same numbers, one byte beside where they should lie."""
    room = np.zeros(array.nbytes + 1, np.uint8)
    shifted = np.ndarray(array.shape, array.dtype, room.data, offset=1)
    shifted[...] = array
    assert array.dtype.itemsize == 1 or not shifted.flags.aligned
    return shifted


def read_only(array: np.ndarray) -> np.ndarray:
    copy = array.copy()
    copy.flags.writeable = False
    return copy


LAYOUTS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "misaligned": misaligned,
    "negative strides": lambda a: np.flip(np.flip(a).copy()),
    "gaps": lambda a: np.repeat(a, 2, axis=0)[::2],
    "Fortran order": np.asfortranarray,
    "read-only": read_only,
    "other byte order": lambda a: a.astype(a.dtype.newbyteorder()),
}


def made(call: str, **changed) -> np.ndarray:
    """What a call makes of its arrays, some of them changed."""
    function, arrays = CALLS[call]
    own = {name: array.copy() if is_output(call, name) else array for name, array in arrays.items()}
    return np.asarray(function(**own | changed))


def annotated_arrays() -> dict[str, set[str]]:
    """Per call of the stubs, the arguments that are arrays."""
    found: dict[str, set[str]] = {}

    def visit(body: list[ast.stmt], prefix: str) -> None:
        for item in body:
            if isinstance(item, ast.ClassDef):
                visit(item.body, f"{item.name}.")
            elif isinstance(item, ast.FunctionDef):
                arguments = item.args.posonlyargs + item.args.args + item.args.kwonlyargs
                is_array = {a.arg for a in arguments if a.annotation and "Array" in ast.unparse(a.annotation)}
                if is_array:
                    found[prefix + item.name] = is_array

    visit(ast.parse(STUBS.read_text(encoding="utf-8")).body, "")
    return found


def test_every_array_of_the_stubs_is_tried():
    stubs = annotated_arrays()
    tried: dict[str, set[str]] = {}
    for call, (_, arrays) in CALLS.items():
        tried.setdefault(call.removesuffix(POSED_SUFFIX), set()).update(arrays)
    assert set(stubs) == set(tried)
    tuples = {"positions", "face_offsets", "face_corners", "weight_offsets", "weight_bones", *TUPLES}
    for call, names in stubs.items():
        if call == "automatic_weights":
            names = names - {"meshes", "locked_weights", "symmetry_plane"} | tuples
        assert tried[call] == names, call


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize(("call", "name"), INPUTS)
def test_layouts_do_not_matter(call: str, name: str, layout: str):
    array = CALLS[call][1][name]
    changed = LAYOUTS[layout](array)
    assert np.array_equal(changed, array)
    assert np.array_equal(made(call, **{name: changed}), made(call))


@pytest.mark.parametrize(("call", "name"), INPUTS)
def test_arrays_that_are_none_are_refused_by_name(call: str, name: str):
    array = CALLS[call][1][name]
    said = CURVES.get(name, TUPLES.get(name, name))
    for wrong in (np.zeros((1,) * (array.ndim + 3)), np.full(array.shape, "word"), array.astype(complex)):
        with pytest.raises(turgor.TurgorError, match=rf"^(frame \d: )?({said})"):
            made(call, **{name: wrong})


@pytest.mark.parametrize(("call", "name"), [(c, n) for c, n in INPUTS if CALLS[c][1][n].dtype.kind != "b"])
def test_numbers_that_are_none_are_refused_by_name(call: str, name: str):
    array = CALLS[call][1][name]
    said = CURVES.get(name, TUPLES.get(name, name))
    is_index = array.dtype.kind == "i"
    for number in (np.nan, np.inf, -np.inf, 1e300, 0.5) if is_index else (np.nan, np.inf, -np.inf):
        wrong = array.astype(float)
        wrong.flat[-1] = number
        with pytest.raises(turgor.TurgorError, match=rf"^(frame \d: )?({said})"):
            made(call, **{name: wrong})


@pytest.mark.parametrize(("call", "name"), WRITTEN)
def test_outputs_that_cannot_be_written_are_refused_by_name(call: str, name: str):
    array = CALLS[call][1][name]
    wrongs = {layout: change(array) for layout, change in LAYOUTS.items()}
    wrongs["fewer rows"] = array[:-1]
    wrongs["another type"] = array.astype(np.float64)
    wrongs["a dimension more"] = array[None]
    wrongs["flat"] = array.ravel()
    for layout, wrong in wrongs.items():
        if layout == "negative strides" and wrong.flags.c_contiguous:
            continue
        with pytest.raises(turgor.TurgorError, match=f"{name}|vertices|offsets"):
            made(call, **{name: wrong})
