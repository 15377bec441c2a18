"""Geometry in kernels."""
