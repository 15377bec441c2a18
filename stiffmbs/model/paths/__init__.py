"""Paths for a driver: curves through points, circles, and the lanes of lane changes."""
