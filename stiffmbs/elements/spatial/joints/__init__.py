"""Spatial joints, one kind per file."""
