"""Compiled loops of the diagnostics."""
