"""Scenes that benchmarks read."""
