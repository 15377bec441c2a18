"""Compiled factorisations of the iteration matrix."""
