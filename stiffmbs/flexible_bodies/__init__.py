"""Flexible bodies: finite element models reduced to interface and normal modes."""
