"""Stress tests of the readers of other programs' files."""
