"""Geometry kernels for contacts between solids."""
