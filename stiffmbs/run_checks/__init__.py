"""Checks that a run applies to its own results, with notes."""
