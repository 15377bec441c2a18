"""Compiled loops over the rows of what is reported."""
