"""What the extension can mend by itself: the buttons beside findings. Found things name one by its identifier."""

FIXES = (
    ("REBIND", "Rebind", "Read the mesh, its weights and its armature again; settings stay"),
    ("MOVE_BELOW_ARMATURE", "Move below Armature", "Move Turgor Volume directly below the last Armature modifier"),
    ("MOVE_AFTER", "Move below Turgor", "Move this modifier below, where it changes what Turgor made"),
    ("MOVE_BELOW", "Move Turgor below It", "Move Turgor Volume below this modifier, where it keeps the volume again"),
    ("MOVE_ABOVE", "Move Turgor above It", "Move Turgor Volume directly above this modifier"),
    ("PLAIN_PARENT", "Plain Parent", "Let the parent move the object without deforming its mesh"),
    ("SHOW_IN_VIEWPORT", "Show in Viewport", "Turn the modifier on in the viewport"),
    ("SHOW_IN_RENDERS", "Show in Renders", "Turn the modifier on in renders"),
    ("NO_MULTI_MODIFIER", "Turn Off Multi Modifier", "Let this Armature modifier deform alone"),
    ("SAME_IN_RENDERS", "Use Viewport Setting in Renders", "Let renders use this modifier as the viewport does"),
    ("SELECT_OPEN_EDGES", "Select Open Edges", "Go to Edit Mode with the edges around openings selected"),
    ("SELECT_NON_MANIFOLD", "Select Edges", "Go to Edit Mode with the edges of three or more faces selected"),
    ("SELECT_UNWEIGHTED", "Select Vertices", "Go to Edit Mode with the vertices selected that no bone holds"),
    ("RECALCULATE_OUTSIDE", "Recalculate Outside", "Turn faces that look inwards, in parts that hold a volume"),
    ("LARGER_SIZE", "Larger Size", "Let half as much skin again take part at this joint"),
    ("CLEAR_GROUP", "Clear Group", "Use no vertex group here"),
)
LABELS = {identifier: label for identifier, label, _ in FIXES}
DESCRIPTIONS = {identifier: description for identifier, _, description in FIXES}
