"""Finite element meshes: reductions, and published shells."""
