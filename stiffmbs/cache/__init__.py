"""Cache on disk, bound to its user."""
