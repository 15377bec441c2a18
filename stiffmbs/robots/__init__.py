"""Scenes from robot descriptions (URDF, MuJoCo's MJCF)."""
