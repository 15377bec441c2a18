"""Explicit Runge-Kutta schemes, one table of coefficients per file, and their integration loops."""
