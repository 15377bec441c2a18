"""Robots as the mappings that scenes are read from."""
