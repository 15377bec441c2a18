"""Loops that numba compiles; imported only when they have to be compiled."""
