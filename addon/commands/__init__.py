"""The command line: `blender -b FILE --command turgor check|report|bake|verify`, without any window."""
