"""Joints, one kind per file."""
