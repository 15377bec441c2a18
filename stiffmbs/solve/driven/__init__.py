"""Motions that drives prescribe: what kinematic analysis integrates."""
