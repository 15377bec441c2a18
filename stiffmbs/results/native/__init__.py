"""Compiled loops of the results."""
