"""Explicit Runge-Kutta steps: start, stages, error estimate, end and interpolant."""
