"""Benchmarks: run time against error, side by side in one process.  One problem per file."""
