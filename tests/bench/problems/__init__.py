"""Benchmark problems: `BENCHMARKS` of each file, the smallest first."""
