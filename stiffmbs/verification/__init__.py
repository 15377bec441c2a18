"""Verification of a run: reruns with tighter tolerances and another integrator, error bars and doubts."""
