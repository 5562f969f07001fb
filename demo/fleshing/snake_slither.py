"""A snake on a chain of bones, skinned as artists do, and fleshed by Turgor Spine, the modifier itself."""

from __future__ import annotations

import bpy
import numpy as np

from blend_fixtures import snake
from blend_fixtures.character import Character, make_character, make_mesh
from blend_fixtures.posing import key_cycle
from blend_fixtures.tube import Tube, chain_weights

from ..enclosed_volume import Points
from ..evaluated import positions
from ..pictures import AFTER_TONE, BEFORE_TONE
from .bodies import Body, cubes
from .experiment import Claim, Experiment, Picture, Table
from .gallery import Gallery, Model
from .tones import tones
from .words import percent, signed

SKINNED, DUAL, FLESHED, EXACT = "Armature", "Preserve Volume", "Turgor Spine", "with Turgor Volume"
WAYS = (SKINNED, DUAL, FLESHED, EXACT)
CUBE = 0.012
"""Edge in metres of the sample cubes, one about each point of the skin."""
FRAMES = range(1, snake.FRAME_COUNT + 1, 2)
LOCAL_LIMIT, TOTAL_LIMIT, EXACT_LIMIT = 1e-3, 1e-3, 1e-6


class Slither:
    """The snake and its sample cubes on one chain of bones, moved by any of `WAYS`."""

    def __init__(self) -> None:
        surface = snake.body_surface()
        self.body = Body(surface.points, surface.quads.tolist())
        self.cubes = cubes(surface.points - CUBE / 2.0, CUBE)
        self.characters = {}
        for name, body in (("snake", self.body), ("cubes", self.cubes)):
            mesh = make_mesh(name, body.points, body.faces)
            self.characters[name] = make_character(name, mesh, snake.BONES, _weights(body.points))
            key_cycle(self.characters[name].armature, snake.FRAME_COUNT, 16, snake.pose_at, snake.BONES[0].name, _flat)

    def set_way(self, way: str) -> None:
        """Modifiers of both: cubes are never corrected, each would be made exact by itself."""
        for name, character in self.characters.items():
            _set_modifiers(character, way, is_corrected=way == EXACT and name == "snake")

    def moved(self, frame: int) -> tuple[Points, Points]:
        """Points of the body and of the cubes, as Blender evaluates them."""
        bpy.context.scene.frame_set(frame)
        body, sample = (positions(character.body) for character in self.characters.values())
        return body, sample

    def remove(self) -> None:
        """Leave the scene as it was."""
        for character in self.characters.values():
            bpy.data.meshes.remove(character.body.data)
            bpy.data.armatures.remove(character.armature.data)


def _weights(points: Points) -> np.ndarray:
    joints = [snake.BONES[0].head, *(bone.tail for bone in snake.BONES)]
    chain = Tube(joints, radius=snake.HEIGHT, spacing=0.1, blend=0.085)
    return chain_weights(chain, np.clip(-points[:, 1] - snake.TAIL, 0.0, None))


def _flat(_: float) -> float:
    return 0.0


def _set_modifiers(character: Character, way: str, *, is_corrected: bool) -> None:
    body, armature = character
    for ours in [modifier for modifier in body.modifiers if modifier.type == "NODES"]:
        body.modifiers.remove(ours)
    bpy.context.view_layer.update()
    body.modifiers["Armature"].use_deform_preserve_volume = way == DUAL
    bpy.context.scene.frame_set(1)
    for ob in bpy.context.view_layer.objects:
        ob.select_set(ob in (body, armature))
    bpy.context.view_layer.objects.active = body
    if way in {FLESHED, EXACT}:
        bpy.ops.object.turgor_spine_add()
    if is_corrected:
        armature.select_set(False)
        bpy.ops.object.turgor_volume_add()


def run(gallery: Gallery) -> Experiment:
    """Lets it slither in every way."""
    slither = Slither()
    total, local, seen = {}, {}, {}
    for way in WAYS:
        slither.set_way(way)
        shapes = [slither.moved(frame) for frame in FRAMES]
        total[way] = max(abs(slither.body.total_error(body)) for body, _ in shapes)
        local[way] = [slither.cubes.local_errors(sample) for _, sample in shapes]
        seen[way] = shapes
    slither.remove()
    mean = {way: float(np.mean([np.abs(errors).mean() for errors in local[way]])) for way in WAYS[:3]}
    worst = {way: float(np.max(np.abs(local[way]))) for way in WAYS[:3]}
    rows = [
        ["total volume, at most", *(percent(total[way]) for way in WAYS)],
        ["small cubes at its skin, mean", *(percent(mean[way]) for way in WAYS[:3]), "–"],
        ["small cubes at its skin, at most", *(percent(worst[way]) for way in WAYS[:3]), "–"],
    ]
    experiment = Experiment(
        "snake",
        "A snake slithers on its bones",
        f"{len(slither.body.points):,} points, {len(snake.BONES)} bones, {len(FRAMES)} frames. Skinning squeezes the "
        "inside of each bend and stretches the outside; preserving volume by dual quaternions hides that behind a "
        "better total. The modifier Turgor Spine leaves every chunk its volume, Turgor Volume after it takes away what "
        "the mesh's own faces leave. Flesh at the skin: blue shrank, red grew.",
        [Table(["Change of volume", *WAYS], rows)],
        [
            Claim("snake, fleshed: small cubes, mean", mean[FLESHED], most=LOCAL_LIMIT),
            Claim("snake, fleshed: total volume", total[FLESHED], most=TOTAL_LIMIT),
            Claim("snake, fleshed and corrected: total volume", total[EXACT], most=EXACT_LIMIT),
        ],
        {"vertices": len(slither.body.points), "total": total, "local_mean": mean, "local_worst": worst},
    )
    experiment.pictures.append(_pictures(gallery, slither, seen, local))
    return experiment


def _pictures(
    gallery: Gallery,
    slither: Slither,
    seen: dict[str, list[tuple[Points, Points]]],
    local: dict[str, list[Points]],
) -> list[Picture]:
    """The frame at which skinning changes most flesh, coloured by what became of it."""
    index = int(np.argmax([np.abs(errors).mean() for errors in local[SKINNED]]))
    shown = {way: seen[way][index][0] for way in (SKINNED, FLESHED)}
    shot = gallery.shot(list(shown.values()), (0.55, -0.35, 1.0), (1000, 620))
    pictures = []
    for way, tone in ((SKINNED, BEFORE_TONE), (FLESHED, AFTER_TONE)):
        errors = local[way][index]
        model = Model(slither.body.moved(shown[way]), tone=tone, colours=tones(errors))
        caption = f"<b>{way}</b>: from {signed(errors.min())} to {signed(errors.max())}"
        pictures.append(gallery.picture(f"snake_{way.split()[-1].lower()}", [model], shot, caption))
    return pictures
