"""Compiled loops of the error control."""
