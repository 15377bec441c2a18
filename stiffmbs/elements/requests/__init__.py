"""Requests: reported formulas, evaluated after the run from its channels."""
