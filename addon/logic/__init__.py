"""Settings and arrays to engine calls; runs without Blender."""
