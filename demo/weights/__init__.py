"""Automatic weights beside Blender's own, on what breaks those."""
