"""Applied forces, one kind per file."""
