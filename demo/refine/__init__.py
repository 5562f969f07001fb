"""Coarse characters with folds and bulges, before and after their meshes are refined where they need it."""
