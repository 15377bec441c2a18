"""Evaluation of runs: loads, driving angles, cycles, and peaks between the output times."""
