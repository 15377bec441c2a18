"""Compiled loops that benchmarks measure."""
