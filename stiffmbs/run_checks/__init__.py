"""What a plain run examines of its own results, and says in its notes."""
