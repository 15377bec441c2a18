"""Models built in Python."""
