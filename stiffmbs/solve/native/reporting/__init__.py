"""Compiled loops over output rows."""
