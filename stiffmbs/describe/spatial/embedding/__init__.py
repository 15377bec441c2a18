"""Planar models in the x-y plane of space: how each kind of thing is written there, one file for each sort."""
