"""Modifiers of every kind that moves vertices, on the bent tube of `tube`, and the body to judge its volume by."""

from __future__ import annotations

import struct
import tempfile
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
from measure import mesh_positions, volume
from tube import LAST_FRAME, LENGTH, bend, play_as_strip, rig, select, tube_mesh, weigh

FRAMES = (1, 6, 13, LAST_FRAME)
Setup = Callable[[bpy.types.Object], bpy.types.Modifier]


def keyed(owner: bpy.types.Object, path: str, first: object, last: object) -> None:
    """Keyframes on a setting of a modifier, or on a property of an object."""
    data, _, name = path.rpartition(".")
    holder = owner.path_resolve(data) if data else owner
    for frame, value in ((1, first), (LAST_FRAME, last)):
        setattr(holder, name, value)
        owner.keyframe_insert(path, frame=frame)


def moving_empty(name: str = "Target") -> bpy.types.Object:
    empty = bpy.data.objects.new(name, None)
    bpy.context.scene.collection.objects.link(empty)
    keyed(empty, "location", (0.1, 0.0, 2.0), (0.6, 0.2, 2.6))
    return empty


def new(ob: bpy.types.Object, kind: str, **settings: object) -> bpy.types.Modifier:
    modifier = ob.modifiers.new(kind.title(), kind)
    for name, value in settings.items():
        setattr(modifier, name, value)
    return modifier


def cage(ob: bpy.types.Object, radius: float = 1.8, *, is_moving: bool = True) -> bpy.types.Object:
    """A wide tube around the body, bent by a rig of its own."""
    mesh = tube_mesh("Cage", rings=9, segments=8)
    points = mesh_positions(mesh)
    points[:, :2] *= radius
    points[:, 2] = (points[:, 2] - LENGTH / 2) * 1.3 + LENGTH / 2
    mesh.attributes["position"].data.foreach_set("vector", points.ravel())
    made = bpy.data.objects.new("Cage", mesh)
    bpy.context.scene.collection.objects.link(made)
    if is_moving:
        other = rig("CageRig", 2)
        weigh(made, 2)
        made.modifiers.new("Bend", "ARMATURE").object = other
        bend(other, 0.7)
    bpy.context.scene.frame_set(1)
    return made


def _lattice(ob: bpy.types.Object) -> bpy.types.Modifier:
    made = bpy.data.objects.new("Lattice", bpy.data.lattices.new("Lattice"))
    bpy.context.scene.collection.objects.link(made)
    made.scale = (4.0, 4.0, 9.0)
    for point, offset in zip(made.data.points, np.linspace(-0.15, 0.15, 8), strict=True):
        point.co_deform.x += offset
    keyed(made, "location", (0.0, 0.0, 2.0), (0.8, 0.3, 2.4))
    return new(ob, "LATTICE", object=made)


def _curve(ob: bpy.types.Object) -> bpy.types.Modifier:
    data = bpy.data.curves.new("Curve", "CURVE")
    data.dimensions = "3D"
    spline = data.splines.new("BEZIER")
    spline.bezier_points.add(1)
    for point, at in zip(spline.bezier_points, ((0, 0, -1), (0.5, 0.3, 6)), strict=True):
        point.co = at
        point.handle_left_type = point.handle_right_type = "AUTO"
    made = bpy.data.objects.new("Curve", data)
    bpy.context.scene.collection.objects.link(made)
    keyed(made, "rotation_euler", (0.0, 0.0, 0.0), (0.2, 0.3, 0.0))
    return new(ob, "CURVE", object=made, deform_axis="POS_Z")


def _displace(ob: bpy.types.Object) -> bpy.types.Modifier:
    texture = bpy.data.textures.new("Clouds", "CLOUDS")
    return new(
        ob, "DISPLACE", texture=texture, texture_coords="OBJECT", texture_coords_object=moving_empty(), strength=0.2
    )


def _hook(ob: bpy.types.Object) -> bpy.types.Modifier:
    return new(ob, "HOOK", object=moving_empty(), falloff_radius=2.0, falloff_type="SMOOTH", strength=0.8)


def _shrinkwrap(ob: bpy.types.Object) -> bpy.types.Modifier:
    mesh = tube_mesh("Wrapped", rings=9, segments=16)
    points = mesh_positions(mesh)
    points[:, :2] *= 1.2
    mesh.attributes["position"].data.foreach_set("vector", points.ravel())
    target = bpy.data.objects.new("Wrapped", mesh)
    bpy.context.scene.collection.objects.link(target)
    keyed(target, "scale", (1.0, 1.0, 1.0), (1.3, 1.1, 1.0))
    return new(ob, "SHRINKWRAP", target=target, wrap_mode="ON_SURFACE")


def _warp(ob: bpy.types.Object) -> bpy.types.Modifier:
    origin = bpy.data.objects.new("From", None)
    bpy.context.scene.collection.objects.link(origin)
    origin.location = (0.0, 0.0, 1.0)
    return new(ob, "WARP", object_from=origin, object_to=moving_empty(), falloff_radius=3.0, strength=0.5)


def _mesh_cache(ob: bpy.types.Object) -> bpy.types.Modifier:
    path = Path(tempfile.mkdtemp()) / "cache.pc2"
    base = mesh_positions(ob.data)
    with path.open("wb") as file:
        file.write(b"POINTCACHE2\0" + struct.pack("<iiffi", 1, len(base), 0.0, 1.0, LAST_FRAME + 1))
        for frame in range(LAST_FRAME + 1):
            grown = base * np.array([1.0 + 0.01 * frame, 1.0, 1.0 - 0.005 * frame], np.float32)
            file.write(grown.astype(np.float32).tobytes())
    return new(ob, "MESH_CACHE", cache_format="PC2", filepath=str(path), factor=0.4)


def _bound(kind: str, operator: str, **settings: object) -> Setup:
    """A cage that is bound while nothing is posed."""

    def setup(ob: bpy.types.Object) -> bpy.types.Modifier:
        around = cage(ob)
        pointer = "target" if kind == "SURFACE_DEFORM" else "object"
        modifier = new(ob, kind, **{pointer: around}, **settings)
        select([ob])
        assert getattr(bpy.ops.object, operator)(modifier=modifier.name) == {"FINISHED"}
        assert modifier.is_bound
        return modifier

    return setup


def _laplacian_deform(ob: bpy.types.Object) -> bpy.types.Modifier:
    group = ob.vertex_groups.new(name="Anchors")
    group.add([0, 5, 60, 130, 200, 251], 1.0, "REPLACE")
    hook = _hook(ob)
    modifier = new(ob, "LAPLACIANDEFORM", vertex_group="Anchors", iterations=1)
    ob.modifiers.move(len(ob.modifiers) - 1, list(ob.modifiers).index(hook))
    select([ob])
    hook.show_viewport = False
    assert bpy.ops.object.laplaciandeform_bind(modifier=modifier.name) == {"FINISHED"}
    hook.show_viewport = True
    ob.modifiers.move(list(ob.modifiers).index(modifier), len(ob.modifiers) - 1)
    return modifier


def moving_nodes(ob: bpy.types.Object) -> bpy.types.Modifier:
    """Geometry Nodes that sway with the scene's time."""
    group = bpy.data.node_groups.new("Sway", "GeometryNodeTree")
    group.is_modifier = True
    for in_out in ("OUTPUT", "INPUT"):
        group.interface.new_socket("Geometry", in_out=in_out, socket_type="NodeSocketGeometry")
    inputs, outputs = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    time, combine = group.nodes.new("GeometryNodeInputSceneTime"), group.nodes.new("ShaderNodeCombineXYZ")
    position, product = group.nodes.new("GeometryNodeInputPosition"), group.nodes.new("ShaderNodeVectorMath")
    moved = group.nodes.new("GeometryNodeSetPosition")
    product.operation = "MULTIPLY"
    group.links.new(time.outputs["Seconds"], combine.inputs["X"])
    group.links.new(combine.outputs[0], product.inputs[0])
    group.links.new(position.outputs[0], product.inputs[1])
    group.links.new(inputs.outputs[0], moved.inputs["Geometry"])
    group.links.new(product.outputs[0], moved.inputs["Offset"])
    group.links.new(moved.outputs[0], outputs.inputs[0])
    return new(ob, "NODES", node_group=group)


def pushed_out(ob: bpy.types.Object) -> bpy.types.Modifier:
    """Geometry Nodes that move all vertices away from the axis by an input, at first 0.1."""
    group = bpy.data.node_groups.new("Push", "GeometryNodeTree")
    group.is_modifier = True
    for in_out in ("OUTPUT", "INPUT"):
        group.interface.new_socket("Geometry", in_out=in_out, socket_type="NodeSocketGeometry")
    amount = group.interface.new_socket("Amount", in_out="INPUT", socket_type="NodeSocketFloat")
    amount.default_value = 0.1
    inputs, outputs = group.nodes.new("NodeGroupInput"), group.nodes.new("NodeGroupOutput")
    normal, scaled = group.nodes.new("GeometryNodeInputNormal"), group.nodes.new("ShaderNodeVectorMath")
    moved = group.nodes.new("GeometryNodeSetPosition")
    scaled.operation = "SCALE"
    group.links.new(normal.outputs[0], scaled.inputs[0])
    group.links.new(inputs.outputs["Amount"], scaled.inputs["Scale"])
    group.links.new(inputs.outputs[0], moved.inputs["Geometry"])
    group.links.new(scaled.outputs[0], moved.inputs["Offset"])
    group.links.new(moved.outputs[0], outputs.inputs[0])
    return new(ob, "NODES", node_group=group)


def set_pushed_out(modifier: bpy.types.NodesModifier, amount: float) -> None:
    if bpy.app.version >= (5, 2, 0):
        modifier.properties.inputs.Socket_2.value = amount
    else:
        modifier["Socket_2"] = amount


def second_rig(ob: bpy.types.Object) -> bpy.types.Modifier:
    """Another armature on other groups."""
    other = rig("Second", 2)
    bend(other, -0.6)
    for index, bone in enumerate(other.data.bones):
        bone.name = f"Other{index}"
        group = ob.vertex_groups.new(name=bone.name)
        for vertex in ob.data.vertices:
            part = min(max(vertex.co.z / LENGTH * 2 - 0.5, 0.0), 1.0)
            group.add([vertex.index], part if index else 1.0 - part, "REPLACE")
    return new(ob, "ARMATURE", object=other)


def _keyed_setting(ob: bpy.types.Object) -> bpy.types.Modifier:
    modifier = new(ob, "CAST", cast_type="CYLINDER")
    keyed(ob, 'modifiers["Cast"].factor', 0.0, 0.6)
    return modifier


def _in_a_strip(ob: bpy.types.Object) -> bpy.types.Modifier:
    modifier = _keyed_setting(ob)
    play_as_strip(ob)
    return modifier


def _driven_setting(ob: bpy.types.Object) -> bpy.types.Modifier:
    """By a property of the character itself, which is keyed on the rig."""
    modifier = new(ob, "SIMPLE_DEFORM", deform_method="TAPER", deform_axis="Z")
    ob["amount"] = 0.4
    driver = ob.driver_add('modifiers["Simple_Deform"].factor').driver
    driver.type = "SCRIPTED"
    variable = driver.variables.new()
    variable.targets[0].id, variable.targets[0].data_path = ob, '["amount"]'
    driver.expression = f"{variable.name} * frame / 20"
    return modifier


KINDS: dict[str, Setup] = {
    "cast": lambda ob: new(ob, "CAST", object=moving_empty(), factor=0.4),
    "corrective smooth": lambda ob: new(ob, "CORRECTIVE_SMOOTH", iterations=5),
    "curve": _curve,
    "displace": _displace,
    "hook": _hook,
    "laplacian deform": _laplacian_deform,
    "laplacian smooth": lambda ob: new(ob, "LAPLACIANSMOOTH", lambda_factor=0.5, iterations=2),
    "lattice": _lattice,
    "mesh cache": _mesh_cache,
    "mesh deform": _bound("MESH_DEFORM", "meshdeform_bind", precision=3),
    "shrinkwrap": _shrinkwrap,
    "simple deform": lambda ob: new(ob, "SIMPLE_DEFORM", origin=moving_empty(), deform_method="BEND", angle=0.5),
    "smooth": lambda ob: new(ob, "SMOOTH", iterations=3),
    "surface deform": _bound("SURFACE_DEFORM", "surfacedeform_bind"),
    "warp": _warp,
    "wave": lambda ob: new(ob, "WAVE", height=0.1, width=0.8, speed=0.2),
    "nodes": moving_nodes,
    "nodes with an input": pushed_out,
    "second rig": second_rig,
    "keyed": _keyed_setting,
    "strip": _in_a_strip,
    "driven": _driven_setting,
}


def body_copy(ob: bpy.types.Object, end: bpy.types.Modifier | None) -> bpy.types.Object:
    """A visible object that shows the body: the stack before `end`, without any modifier when there is none."""
    copy = ob.copy()
    bpy.context.scene.collection.objects.link(copy)
    count = 0 if end is None else list(ob.modifiers).index(end)
    for modifier in list(copy.modifiers)[count:]:
        copy.modifiers.remove(modifier)
    return copy


def worst_error(ob: bpy.types.Object, body: bpy.types.Object, frames: tuple[int, ...] = FRAMES) -> float:
    """|V / V(body) - 1| of what Blender evaluates."""
    worst = 0.0
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        worst = max(worst, abs(volume(ob) / volume(body) - 1.0))
    return worst
