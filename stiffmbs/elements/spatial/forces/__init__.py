"""Spatial applied forces, one kind per file."""
