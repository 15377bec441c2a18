"""Applied forces in space, one kind per file."""
