"""Transformations of a scene that must not change its motion, and the comparison of both runs."""
