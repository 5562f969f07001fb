"""Where Blender data and the engine meet: binding, the frame, the two routes, housekeeping."""
