"""Linear systems of multibody dynamics: block systems, elimination orders, factors."""
