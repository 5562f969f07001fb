"""Drivers without Python expressions: they run where scripts in files are not allowed."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import bpy

from . import modifier_inputs, node_group

TICK_MODIFIER = "Turgor Tick"
# A harmless switch of the user interface: writing it makes the dependency graph evaluate the carrier's geometry.
TICK_PATH = f'modifiers["{TICK_MODIFIER}"].show_group_selector'


class Source(NamedTuple):
    """What a driver variable reads: a property, or the place of an object or bone."""

    kind: str
    id_type: str
    owner: bpy.types.ID
    path: str  # of the property; name of the bone


def follow_armature(ob: bpy.types.Object, ours: bpy.types.NodesModifier, armature: bpy.types.ArmatureModifier) -> None:
    """Drive our hidden inputs by the switches of the Armature modifier."""
    for identifier in _SWITCHES:
        _follow_switch(ob, ours, armature, identifier)


def follows(ob: bpy.types.Object, ours: bpy.types.NodesModifier, armature: bpy.types.ArmatureModifier) -> bool:
    """Whether our input for the viewport is driven by this Armature."""
    animation = ob.animation_data
    curve = (
        None if animation is None else animation.drivers.find(modifier_inputs.input_path(ours, node_group.IN_VIEWPORT))
    )
    if curve is None or not curve.driver.variables:
        return False
    return curve.driver.variables[0].targets[0].data_path == _switch_path(armature, node_group.IN_VIEWPORT)


def unfollow(ob: bpy.types.Object, ours: bpy.types.NodesModifier) -> None:
    """No Armature any more: on everywhere."""
    for identifier in _SWITCHES:
        if ob.driver_remove(modifier_inputs.input_path(ours, identifier)):
            modifier_inputs.write_input(ours, identifier, True)


def stand_alone(ob: bpy.types.Object, ours: bpy.types.NodesModifier, *, in_renders: bool) -> None:
    """Follow no Armature: on in the viewport whatever is on before, and in renders if so wanted."""
    for identifier, value in ((node_group.IN_VIEWPORT, True), (node_group.IN_RENDER, in_renders)):
        is_driven = ob.driver_remove(modifier_inputs.input_path(ours, identifier))
        if is_driven or modifier_inputs.read_input(ours, identifier) != value:
            modifier_inputs.write_input(ours, identifier, value)
            ob.update_tag()


def set_in_renders(
    ob: bpy.types.Object, ours: bpy.types.NodesModifier, armature: bpy.types.ArmatureModifier, is_same: bool
) -> None:
    """Renders follow the Armature modifier where they show the bound mesh, else they are plain skinning."""
    path = modifier_inputs.input_path(ours, node_group.IN_RENDER)
    animation = ob.animation_data
    if is_same == (animation is not None and animation.drivers.find(path) is not None):
        return
    if is_same:
        _follow_switch(ob, ours, armature, node_group.IN_RENDER)
    else:
        ob.driver_remove(path)
        modifier_inputs.write_input(ours, node_group.IN_RENDER, False)
    ob.update_tag()


def remove_stray(ob: bpy.types.Object) -> None:
    """Our drivers that Blender leaves behind when it applies a modifier."""
    if ob.animation_data is None:
        return
    for curve in list(ob.animation_data.drivers):
        found = modifier_inputs.parse_path(curve.data_path)
        if found is not None and found[0] not in ob.modifiers and found[1] in _SWITCHES:
            ob.animation_data.drivers.remove(curve)


_SWITCHES = {node_group.IN_VIEWPORT: "show_viewport", node_group.IN_RENDER: "show_render"}


def _follow_switch(
    ob: bpy.types.Object, ours: bpy.types.NodesModifier, armature: bpy.types.ArmatureModifier, identifier: str
) -> None:
    driver = _new_driver(ob, modifier_inputs.input_path(ours, identifier))
    _add_variable(driver, Source("SINGLE_PROP", "OBJECT", ob, _switch_path(armature, identifier)))


def _switch_path(armature: bpy.types.ArmatureModifier, identifier: str) -> str:
    return f'modifiers["{bpy.utils.escape_identifier(armature.name)}"].{_SWITCHES[identifier]}'


def write_tick(carrier: bpy.types.Object, sources: Iterable[Source]) -> None:
    """Let the carrier's `tick` be read after its target's settings and `sources` have been evaluated.

    Left alone when it already does: a new driver makes Blender rebuild the dependency graph.
    """
    wanted = [*_own_sources(carrier), *sources]
    curve = tick_curve(carrier)
    if curve is not None and [_source(variable) for variable in curve.driver.variables] == wanted:
        return
    driver = _new_driver(carrier, TICK_PATH)
    for source in wanted:
        _add_variable(driver, source)


def write_reader(ob: bpy.types.Object, path: str, sources: Iterable[Source]) -> None:
    """Let `sources` be evaluated before what `path`, a setting of the object, is about."""
    driver = _new_driver(ob, path)
    for source in sources:
        _add_variable(driver, source)


def revalidate_tick(carrier: bpy.types.Object) -> None:
    """A driver that ran without the extension stays marked as broken until its type is set again."""
    curve = tick_curve(carrier)
    if curve is not None:
        curve.driver.type = curve.driver.type


def tick_curve(carrier: bpy.types.Object) -> bpy.types.FCurve | None:
    """The driver of `write_tick`."""
    animation = carrier.animation_data
    return None if animation is None else animation.drivers.find(TICK_PATH)


def _new_driver(owner: bpy.types.ID, path: str) -> bpy.types.Driver:
    owner.driver_remove(path)
    curve = owner.driver_add(path)
    while curve.modifiers:
        curve.modifiers.remove(curve.modifiers[0])
    curve.driver.type = "SUM"
    return curve.driver


def character_sources(target: bpy.types.Object, rig: bpy.types.Object | None) -> list[Source]:
    """Where both stand, and all settings and shape keys of the character."""
    return [
        Source("TRANSFORMS", "OBJECT", target, ""),
        *([] if rig is None else [Source("TRANSFORMS", "OBJECT", rig, "")]),
        # All settings of an object are evaluated as one.
        Source("SINGLE_PROP", "OBJECT", target, "turgor.target_volume"),
        *shape_key_sources(target.data.shape_keys),
    ]


def _own_sources(carrier: bpy.types.Object) -> list[Source]:
    target = carrier.turgor.carrier.target
    settings = {"VOLUME": "turgor.target_volume", "SPINE": "turgor_spine.slide"}[carrier.turgor.carrier.kind]
    return [
        Source("SINGLE_PROP", "OBJECT", carrier, "turgor.carrier.tick"),
        Source("SINGLE_PROP", "MESH", carrier.turgor.carrier.mesh, "use_auto_texspace"),
        Source("SINGLE_PROP", "MESH", target.data, "use_auto_texspace"),
        # All settings of an object are evaluated as one.
        Source("SINGLE_PROP", "OBJECT", target, settings),
        Source("TRANSFORMS", "OBJECT", target, ""),
        *shape_key_sources(target.data.shape_keys),
    ]


def bone_sources(rig: bpy.types.Object, bone_names: Iterable[str]) -> list[Source]:
    """Where an armature and its bones stand, and how the segments of bendy ones lie."""
    names = tuple(bone_names)
    stand = [Source("TRANSFORMS", "OBJECT", rig, name) for name in ("", *names)]
    bendy = (bpy.utils.escape_identifier(name) for name in names if rig.data.bones[name].bbone_segments > 1)
    return stand + [Source("SINGLE_PROP", "OBJECT", rig, f'pose.bones["{name}"].bbone_curveinx') for name in bendy]


def geometry_source(ob: bpy.types.Object) -> Source:
    """The evaluated mesh of an object."""
    return Source("SINGLE_PROP", "OBJECT", ob, "data")


def curve_sources(curve: bpy.types.Object) -> list[Source]:
    """Where a curve object and the holders of its hooks stand, and its evaluated control points."""
    sources = [
        Source("TRANSFORMS", "OBJECT", curve, ""),
        # The data of an evaluated curve object is a copy made with its geometry, and only its size waits for that.
        Source("SINGLE_PROP", "OBJECT", curve, "dimensions[0]"),
    ]
    for modifier in curve.modifiers:
        if modifier.type == "HOOK" and modifier.object is not None:
            sources.append(Source("TRANSFORMS", "OBJECT", modifier.object, modifier.subtarget))
    return sources


def shape_key_sources(keys: bpy.types.Key | None) -> list[Source]:
    """Values of all keys but the reference."""
    if keys is None:
        return []
    names = (bpy.utils.escape_identifier(key.name) for key in keys.key_blocks[1:])
    return [Source("SINGLE_PROP", "KEY", keys, f'key_blocks["{name}"].value') for name in names]


def _source(variable: bpy.types.DriverVariable) -> Source:
    target = variable.targets[0]
    if variable.type == "TRANSFORMS":
        return Source(variable.type, "OBJECT", target.id, target.bone_target)
    return Source(variable.type, target.id_type, target.id, target.data_path)


def _add_variable(driver: bpy.types.Driver, source: Source) -> None:
    variable = driver.variables.new()
    variable.type = source.kind
    target = variable.targets[0]
    if source.kind == "TRANSFORMS":
        target.id, target.bone_target = source.owner, source.path
        target.transform_type, target.transform_space = "LOC_X", "WORLD_SPACE"
    else:
        target.id_type, target.id, target.data_path = source.id_type, source.owner, source.path
