"""Judges and tools for tables of variants."""
