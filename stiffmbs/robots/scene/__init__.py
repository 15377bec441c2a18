"""Conversion of robots to scene mappings."""
