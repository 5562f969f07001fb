"""Lines of the extension, and of the engine where only its Python laws judge, each broken in one way."""

from __future__ import annotations

from typing import NamedTuple


class BrokenLine(NamedTuple):
    """`before` stands once in the file; with `after` in its place one of the tests must fail."""

    path: str
    before: str
    after: str
    tests: tuple[str, ...]


_CARRIERS = ("tests/blender/test_carriers.py",)
_PATHS = ("tests/engine/test_one_frame_all_paths.py",)
_SKINNING = ("tests/engine/test_skinning.py",)
_FOLDS = ("tests/engine/test_folds.py",)
_MASKS = ("tests/engine/test_masks.py", "tests/blender/test_masks.py")
_MEASURED = ("tests/blender/test_measured_figures.py",)
_VOLUME = ("tests/blender/test_measured_volume.py",)
_LATER = ("tests/blender/test_later_modifiers.py",)
_ANY_STACK = ("tests/blender/test_operators_on_any_stack.py",)
_ADDED = ("tests/engine/test_added_offsets.py",)
_RESIDUAL = ("tests/engine/test_masks.py", "tests/engine/test_exactness.py", "tests/engine/test_extreme_scales.py")
_FLESH = ("tests/engine/test_flesh_law.py",)
_EVEN = ("tests/engine/test_even_fields.py",)
_FLEX = ("tests/engine/test_flex.py",)
_NEW_CHARACTERS = ("tests/blender/test_flesh_law.py",)

BROKEN_LINES = (
    # Guards and carriers
    BrokenLine(
        "addon/live/frame.py",
        "deform_into_address(address, vertex_count,",
        "deform_into_address(address, bound.body.vertex_count,",
        _CARRIERS,
    ),
    BrokenLine(
        "addon/live/spine_frame.py",
        "bound.flesh.vertex_count != vertex_count:\n        #",
        "False:\n        #",
        _CARRIERS,
    ),
    BrokenLine("addon/live/pull.py", "ctypes.memset(address, 0, vertex_count * FLOAT3_BYTES)", "pass", _CARRIERS),
    BrokenLine("addon/live/push.py", "        offsets[...] = 0.0\n", "        pass\n", _CARRIERS),
    BrokenLine("addon/live/guard.py", "except BaseException as error", "except Exception as error", _CARRIERS),
    BrokenLine(
        "addon/live/guard.py",
        "        runtime.set_failure(state, original.name, findings.of_error(original, error))\n",
        "",
        _CARRIERS,
    ),
    BrokenLine(
        "addon/live/guard.py", "        runtime.set_failure(state, original.name, None)", "        pass", _CARRIERS
    ),
    BrokenLine("addon/scene/carrier.py", "mesh.library is not None or mesh in taken", "mesh in taken", _CARRIERS),
    BrokenLine("addon/scene/carrier.py", "or mesh in taken or", "or", _CARRIERS),
    BrokenLine("addon/runtime.py", "if ob is None or ob.session_uid != uid:", "if ob is None:", _CARRIERS),
    # What is shown is measured
    BrokenLine(
        "addon/logic/figures.py",
        "None if shown_volumes is None else _deviation(np.abs(shown_volumes).sum(), target)",
        "_deviation(np.abs(report.corrected_volumes).sum(), target)",
        _MEASURED,
    ),
    BrokenLine("addon/live/frame.py", "or len(positions) != bound.body.vertex_count ", "", _MEASURED),
    # The engine, where its laws are written in Python
    BrokenLine(
        "rust/core/src/skinning/blend.rs", "let moves = sum > WEIGHT_SUM_MIN", "let moves = sum > 0.0", _SKINNING
    ),
    BrokenLine("rust/core/src/frame/repair.rs", "if is_exact && folds < best.0", "if folds < best.0", _FOLDS),
    BrokenLine(
        "rust/core/src/frame/offsets.rs",
        "c[axis] * p.z + d[axis];",
        "c[axis] * p.z;",
        _PATHS,
    ),
    BrokenLine("rust/core/src/frame/offsets.rs", "+ f64x4::splat(simd, d[axis])", "", _PATHS),
    BrokenLine(
        "rust/core/src/binding.rs",
        "else { patches.component_of_slot(slot as usize) }",
        "else { topology.component_of_point[point as usize] }",
        _PATHS,
    ),
    BrokenLine("rust/core/src/frame/offsets.rs", "!binding.sites.is_split() && ", "", _PATHS),
    BrokenLine("rust/core/src/spine/flow.rs", "&self.cells[0]", "&self.cells[70]", ("tests/engine/test_spine_map.py",)),
    BrokenLine("rust/core/src/frame/mask.rs", "if m < *least { m } else { *least }", "m", _MASKS[:1]),
    BrokenLine("rust/core/src/frame/mask.rs", "for_each(|m| *m /= most)", "for_each(|_| ())", _MASKS[:1]),
    # What stands after ours, and measured volumes
    BrokenLine("addon/scene/later_modifiers.py", "double.modifiers[name].show_viewport = True", "pass", _LATER),
    BrokenLine(
        "addon/scene/later_modifiers.py", "([*each, *bending] for each in posed)", "(each for each in posed)", _LATER
    ),
    BrokenLine("addon/live/later_findings.py", "if character.later_seen != seen:", "if True:", _LATER),
    BrokenLine("addon/live/later_findings.py", "np.array_equal(last, shown)", "True", _LATER),
    BrokenLine("addon/live/measured.py", "stack_volumes.rounding_volume(mesh, positions, reach):", "1e9:", _VOLUME),
    BrokenLine("addon/logic/stack_volumes.py", "np.sqrt(3.0) * ROUNDINGS", "1e-3", _VOLUME),
    BrokenLine("addon/scene/stack.py", "        ob.modifiers.remove(ours)\n", "        pass\n", _ANY_STACK),
    BrokenLine(
        "addon/scene/modifier_places.py", "        modifier.use_pin_to_last = True\n", "        pass\n", _ANY_STACK
    ),
    # What Rust's own tests leave to laws in Python
    BrokenLine("rust/core/src/skinning/dual_quaternion.rs", "< 0.0 { -weight }", "< 0.0 { weight }", _SKINNING),
    BrokenLine("rust/core/src/frame/added.rs", "1.0 / coincident.len().max(1) as f64", "1.0", _ADDED),
    BrokenLine("rust/core/src/frame/offsets.rs", "largest_squared.fetch_max(", "largest_squared.fetch_min(", _PATHS),
    BrokenLine(
        "rust/core/src/frame/residual.rs", "is_masked && !state.is_linear_only", "!state.is_linear_only", _RESIDUAL
    ),
    BrokenLine("rust/core/src/frame/residual.rs", "&& (!may_give_up || is_exact(step))", "", _RESIDUAL),
    BrokenLine(
        "rust/core/src/frame/residual.rs", "None => state.step = f64::NAN", "None => state.step = 0.0", _RESIDUAL
    ),
    # The law of flesh, and even fields
    BrokenLine("addon/live/housekeeping.py", "saved.flesh, saved.fields = 1.0, ", "saved.fields = ", _NEW_CHARACTERS),
    BrokenLine(
        "addon/live/housekeeping.py", 'saved.flesh, saved.fields = 1.0, "EVEN"', "saved.flesh = 1.0", _NEW_CHARACTERS
    ),
    BrokenLine(
        "rust/core/src/flesh/twist.rs", " + (along - blended) * link.spread) * link.twist", ") * link.twist", _FLESH
    ),
    BrokenLine("rust/core/src/flesh/turn.rs", "amount * sound * fade(angle)", "amount * sound", _FLESH),
    BrokenLine("rust/core/src/flesh/turn.rs", "wider: WIDER *", "wider: 0.0 *", _FLESH),
    BrokenLine("rust/core/src/flesh/bend.rs", "(self.weight * self.weight).max(self.square)", "self.square", _FLESH),
    BrokenLine("rust/core/src/flesh/crease.rs", "side(rest.along) * pushed * closes", "pushed * 0.0", _FLESH),
    BrokenLine("rust/core/src/flesh/crease.rs", "*free *= -touch + 1.0", "*free *= touch * 0.0 + 1.0", _FLESH),
    BrokenLine("rust/core/src/flesh/neighbours.rs", "smoothstep((share - TRUST[0])", "1.0 + 0.0 * (share", _FLESH),
    BrokenLine(
        "rust/core/src/frame/carried.rs",
        "(x[place] + a, y[place] + b, z[place] + c)",
        "(x[place], y[place], z[place])",
        _EVEN,
    ),
    BrokenLine("rust/core/src/frame/carried.rs", "added / most", "1.0", _EVEN),
    BrokenLine(
        "rust/core/src/frame/carried.rs",
        "1.0 - smoothstep((evenness - EVENNESS[0]) / (EVENNESS[1] - EVENNESS[0]))",
        "0.0",
        _EVEN,
    ),
    BrokenLine("rust/core/src/fields/field.rs", "volume + frame.flex * free", "volume", _FLEX),
    BrokenLine("rust/core/src/fields/field.rs", "flex: 0.0, ..*self", "..*self", _FLEX),
    BrokenLine("rust/core/src/fields/patch_sums.rs", "d[axis] * (1.0 - share) + g[axis] * part", "d[axis]", _EVEN),
    BrokenLine(
        "rust/core/src/fields/patch_sums.rs", "volumes[i] = g[0] * d[0] + g[1] * d[1] + g[2] * d[2]", "()", _EVEN
    ),
)
