"""Static equilibria and steady motions."""
