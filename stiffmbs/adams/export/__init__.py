"""Scenes as datasets of Adams/Solver."""
