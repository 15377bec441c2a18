"""Tolerances, error tests, and Newton's test of convergence."""
