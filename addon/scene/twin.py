"""Twins of a character: hidden objects that show its mesh with a part of its modifiers, for us to read the result.

The *pose* has all modifiers before Turgor Volume, the *body* those before the Armature. Blender evaluates both before
the carrier's tick, in every dependency graph that needs the character. They share its mesh, its actions and, by a
constraint, its place. They stand in no scene; the carrier names them and takes them along when it goes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any, Literal

import bpy

from . import modifier_inputs, node_group, rest, stack

Part = Literal["pose", "body"]
PARTS: tuple[Part, ...] = ("pose", "body")
LABELS = {"pose": "Turgor Pose", "body": "Turgor Body"}
END = "Turgor End"


class StepError(ValueError):
    """A twin has other settings than its character, which a script changed just now."""


def twins() -> Iterator[bpy.types.Object]:
    """All twins of the file."""
    return (ob for ob in bpy.data.objects if is_twin(ob))


def is_twin(ob: bpy.types.Object) -> bool:
    """Whether the object is a twin."""
    return ob.type == "MESH" and ob.turgor.carrier.is_twin


def of_carrier(holder: bpy.types.Object, part: Part) -> bpy.types.Object | None:
    """The twin that a carrier names; evaluated if the carrier is."""
    return getattr(holder.turgor.carrier, f"{part}_twin")


def read_modifiers(ob: bpy.types.Object, part: Part) -> list[bpy.types.Modifier]:
    """Of a character, those that its twin has; of a twin all that are the character's."""
    if is_twin(ob):
        found = [modifier for modifier in ob.modifiers if modifier.name != END]
    elif part == "pose":
        found = stack.modifiers_to_own(ob)
    else:
        modifiers, end = list(ob.modifiers), stack.body_end(ob)
        found = modifiers if end is None else modifiers[: modifiers.index(end)]
    return [modifier for modifier in found if modifier.type not in stack.IDLE_TYPES]


def keep(ob: bpy.types.Object, holder: bpy.types.Object, part: Part, *, is_needed: bool) -> None:
    """Let the carrier name a twin that is as its character is now, or none. Only of what may be written."""
    twin = of_carrier(holder, part)
    if not is_needed:
        if twin is not None:
            setattr(holder.turgor.carrier, f"{part}_twin", None)
            remove_unused([twin])
        return
    if twin is not None and _update(ob, twin, part):
        return
    made = _make(ob, part)
    setattr(holder.turgor.carrier, f"{part}_twin", made)
    if twin is not None:
        remove_unused([twin])


def remove_unused(candidates: Sequence[bpy.types.Object] | None = None) -> None:
    """Local twins, of these or of all, that no carrier names."""
    found = list(twins() if candidates is None else candidates)
    if not found:
        return
    holders = [ob.turgor.carrier for ob in bpy.data.objects if ob.turgor.carrier.mesh is not None]
    named = {each for holder in holders for each in (holder.pose_twin, holder.body_twin)}
    for twin in found:
        if twin.library is None and twin not in named:
            bpy.data.objects.remove(twin)


def is_in_step(ob: bpy.types.Object, twin: bpy.types.Object, part: Part, *, with_animated: bool = True) -> bool:
    """Whether a twin would be made as it is. Of the originals; safe on a worker thread.

    with_animated: False leaves out values of animated settings, which Blender writes while it evaluates.
    """
    return signature(ob, part, with_animated) == signature(twin, part, with_animated)


def has_same_values(ob: bpy.types.Object, twin: bpy.types.Object, animated: stack.Animated) -> bool:
    """Whether animated settings have the same values now; both evaluated. The artist may have changed one by hand."""
    for name, settings in animated.items():
        one, other = ob.modifiers.get(name), twin.modifiers.get(name)
        if one is not None and other is not None and any(_value(one, key) != _value(other, key) for key in settings):
            return False
    return True


def _value(modifier: bpy.types.Modifier, setting: str) -> object:
    if modifier.type == "NODES" and modifier_inputs.has_input(modifier, setting):
        value = modifier_inputs.read_input(modifier, setting)
    else:
        value = getattr(modifier, setting, None)
    return tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value


def signature(ob: bpy.types.Object, part: Part, with_animated: bool = True) -> tuple[object, ...]:
    """What a twin has of its character, but what both follow: mesh, keyframes, drivers, place."""
    modifiers = read_modifiers(ob, part)
    animated = {} if with_animated or ob.animation_data is None else stack.animated_settings(ob)
    pinned = ob.active_shape_key_index if ob.show_only_shape_key else -1
    return (
        ob.data.session_uid,
        pinned,
        *(_settings(modifier, animated.get(modifier.name, frozenset())) for modifier in modifiers),
        *_animation(ob, {modifier.name for modifier in modifiers}),
    )


def _settings(modifier: bpy.types.Modifier, but: frozenset[str]) -> tuple[object, ...]:
    found = [modifier.type, *stack.settings_of(modifier, but)]
    if modifier.type == "NODES" and modifier.node_group is not None:
        found += modifier_inputs.read_attributes(modifier)
    return tuple(found)


def _make(ob: bpy.types.Object, part: Part) -> bpy.types.Object:
    twin = ob.copy()
    if twin.override_library is not None:
        twin.make_local()
    twin.name = f"{LABELS[part]} {ob.name}"
    wanted = {modifier.name for modifier in read_modifiers(ob, part)}
    for modifier in list(twin.modifiers):
        if modifier.name not in wanted:
            rest.remove_with_drivers(twin, modifier)
    for name in ("turgor", "turgor_spine", "turgor_bake"):
        twin.property_unset(name)
    twin.turgor.carrier.is_twin = True
    # Without a modifier Blender would hand out the mesh itself.
    twin.modifiers.new(END, "NODES").node_group = node_group.ensure_tick()
    twin.use_fake_user = twin.show_instancer_for_render = False
    twin.hide_viewport = twin.hide_render = False
    twin.instance_type = "NONE"
    if twin.asset_data is not None:
        twin.asset_clear()
    _keep_animation_of(twin, ob, wanted)
    twin.parent = None
    for constraint in list(twin.constraints):
        twin.constraints.remove(constraint)
    twin.constraints.new("COPY_TRANSFORMS").target = ob
    return twin


def _keep_animation_of(twin: bpy.types.Object, ob: bpy.types.Object, names: set[str]) -> None:
    """Only what moves its modifiers; drivers that read the character go on reading it."""
    animation = twin.animation_data
    if animation is None:
        return
    for curve in list(animation.drivers):
        if not _is_about(curve.data_path, names):
            animation.drivers.remove(curve)
            continue
        for variable in curve.driver.variables:
            for target in variable.targets:
                if target.id == twin:
                    target.id = ob
    if not any(_is_about(path, names) for path in stack.keyed_paths(animation)):
        animation.action = None
        for track in list(animation.nla_tracks):
            animation.nla_tracks.remove(track)
    if animation.action is None and not len(animation.nla_tracks) and not len(animation.drivers):
        twin.animation_data_clear()


def _is_about(path: str, names: set[str]) -> bool:
    return any(path.startswith(f'modifiers["{bpy.utils.escape_identifier(name)}"]') for name in names)


def _update(ob: bpy.types.Object, twin: bpy.types.Object, part: Part) -> bool:
    """Write into a twin what differs; False where it has to be made anew."""
    if twin.library is not None or twin.override_library is not None:
        return is_in_step(ob, twin, part)
    pairs = list(zip(read_modifiers(ob, part), read_modifiers(twin, part), strict=False))
    if any((one.name, one.type) != (other.name, other.type) for one, other in pairs) or is_in_step(ob, twin, part):
        return is_in_step(ob, twin, part)
    for source, copy in pairs:
        if _settings(source, frozenset()) != _settings(copy, frozenset()):
            # What cannot be written makes another twin.
            with suppress(AttributeError, TypeError, ValueError):
                _write(source, copy)
    if not is_in_step(ob, twin, part):
        return False
    # Without its keyframes, which would undo what the artist changed by hand.
    twin.update_tag(refresh={"DATA"})
    return True


def _write(source: bpy.types.Modifier, copy: bpy.types.Modifier) -> None:
    for prop in source.bl_rna.properties:
        if prop.is_readonly or prop.type == "COLLECTION" or prop.identifier in stack.NOT_SETTINGS:
            continue
        if prop.identifier.startswith(stack.EVALUATING_SETTINGS):
            continue
        value = getattr(source, prop.identifier)
        if getattr(prop, "is_array", False):
            value = tuple(value)
        if prop.type != "POINTER" or isinstance(value, bpy.types.ID):
            current = getattr(copy, prop.identifier)
            if (tuple(current) if isinstance(value, tuple) else current) != value:
                setattr(copy, prop.identifier, value)
    if source.type == "NODES" and source.node_group is not None:
        for identifier in modifier_inputs.identifiers(source):
            if modifier_inputs.has_input(copy, identifier):
                modifier_inputs.write_input(copy, identifier, modifier_inputs.read_input(source, identifier))


def _animation(ob: bpy.types.Object, names: set[str]) -> Iterator[object]:
    """Who moves these modifiers' settings."""
    animation = ob.animation_data
    if animation is None:
        return
    for curve in animation.drivers:
        if _is_about(curve.data_path, names):
            yield _plain(curve), [_plain(modifier) for modifier in curve.modifiers]
            yield [_plain(key) for key in curve.keyframe_points]
            yield (
                _plain(curve.driver),
                [
                    (_plain(variable), [_plain(target) for target in variable.targets])
                    for variable in curve.driver.variables
                ],
            )
    if any(_is_about(path, names) for path in stack.keyed_paths(animation)):
        yield _plain(animation), getattr(animation.action_slot, "handle", 0)
        for track in animation.nla_tracks:
            yield _plain(track)
            for strip in track.strips:
                yield from _strip(strip)


def _strip(strip: bpy.types.NlaStrip) -> Iterator[object]:
    yield _plain(strip), getattr(strip.action_slot, "handle", 0)
    if not strip.use_animated_influence:
        yield strip.influence
    for curve in strip.fcurves:
        yield [_plain(key) for key in curve.keyframe_points]
    for inner in strip.strips:
        yield from _strip(inner)


# What the artist chooses in an editor, and what Blender works out.
_NOT_SETTINGS = frozenset(
    "active is_valid is_simple_expression select lock hide group color color_mode is_empty influence_animated"
    " select_control_point select_left_handle select_right_handle strip_time influence last_slot_identifier"
    " use_tweak_mode is_override_data array_index_name show_debug_info auto_smoothing".split()
)


def _plain(data: Any) -> tuple[object, ...]:
    """Plain values of all settings; other data by its uid."""
    found: list[object] = []
    for prop in data.bl_rna.properties:
        if prop.identifier in _NOT_SETTINGS or prop.type == "COLLECTION":
            continue
        value = getattr(data, prop.identifier)
        if isinstance(value, bpy.types.ID):
            found.append(value.session_uid)
        elif prop.type != "POINTER":
            found.append(tuple(value) if getattr(prop, "is_array", False) else value)
    return tuple(found)
