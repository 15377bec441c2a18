"""Conversion of a dataset to a scene mapping, section by section."""
