"""Embedding of planar models in the x-y plane of space."""
