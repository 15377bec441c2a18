"""Errors of runs with explicit steps, by a second run at a larger tolerance."""
