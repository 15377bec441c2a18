"""Benchmark problems, one per file; `contestants` gives the ways to solve it."""
