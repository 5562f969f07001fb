"""The demonstration: a character played with and without Turgor in real Blender, measured, pictured, reported."""
