"""Robots from MJCF files, as compiled by MuJoCo."""
