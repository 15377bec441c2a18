"""Comparisons of solvers with each other."""
