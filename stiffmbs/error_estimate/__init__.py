"""Estimate of the error of a run: its local errors, transported along the recorded steps."""
