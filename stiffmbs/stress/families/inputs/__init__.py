"""Inputs over time."""
