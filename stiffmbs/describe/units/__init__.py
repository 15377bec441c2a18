"""Dimensions, units, and numbers that carry them."""
