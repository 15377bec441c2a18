"""Compiled loops of the run checks."""
