"""Tolerances, error tests and the convergence test of Newton's iteration."""
