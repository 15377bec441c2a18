"""Roads, one kind per file."""
