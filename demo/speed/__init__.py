"""How long frames take, beside Blender's Armature modifier on the same mesh, and bakes, beside stepping."""
