"""Robots of other programs' formats."""
