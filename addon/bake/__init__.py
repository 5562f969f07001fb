"""Baking: what the live modifiers show over a range of frames is kept in shape keys or a point cache."""
