"""Joints in space, one kind per file."""
