"""Formulas in scenes: their text, functions and names, fields that hold them, and their values."""
