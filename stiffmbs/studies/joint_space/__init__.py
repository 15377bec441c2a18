"""Models in the coordinates of their joints."""
