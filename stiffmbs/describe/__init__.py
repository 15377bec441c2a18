"""Describing a mechanism: bodies, markers, joints, forces and scenes.  Knows no numerics."""
