"""Formulas in scenes: text, functions, names, fields and values."""
