"""Parsing and validation of single Adams/Solver statements."""
