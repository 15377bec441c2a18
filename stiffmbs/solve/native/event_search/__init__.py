"""Compiled search for events within steps."""
