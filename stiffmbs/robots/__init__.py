"""Robots described by other programs (URDF, MuJoCo's MJCF) as scenes."""
