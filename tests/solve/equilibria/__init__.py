"""Static equilibria and steady motions: their derivatives, and what their search needs."""
