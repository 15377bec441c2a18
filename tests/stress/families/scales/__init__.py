"""Scales: lengths, masses, durations, tolerances, sizes."""
