"""Requests: formulas that are reported, evaluated after the run from its channels."""
