"""Models that are built in Python, piece by piece."""
