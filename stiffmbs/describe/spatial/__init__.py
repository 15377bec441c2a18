"""Describing mechanisms in space: what differs from the plane, in files of the same names."""
