"""Vehicles on piecewise linear roads, and an independent integration of a wheel."""
