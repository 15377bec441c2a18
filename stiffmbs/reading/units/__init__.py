"""Dimensions, units, and numbers with units."""
