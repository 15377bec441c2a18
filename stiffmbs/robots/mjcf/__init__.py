"""Robots from MuJoCo's format MJCF, as MuJoCo's own compiler understands it."""
