"""Drawings in the 3D viewport: of what was computed elsewhere, nothing else."""
