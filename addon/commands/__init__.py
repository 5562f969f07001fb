"""The command line: `blender -b FILE --command turgor check|report|bake|verify|export|refine`, without any window."""
