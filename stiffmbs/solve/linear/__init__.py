"""Linear systems of mechanics: block systems, orders of elimination, factors."""
