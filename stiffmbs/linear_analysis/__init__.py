"""Linear analysis: state matrices on the constraint manifold, modes, and frequency response about a state."""
