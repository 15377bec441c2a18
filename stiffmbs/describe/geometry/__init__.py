"""Shapes of bodies for drawings; they do not affect the equations."""
