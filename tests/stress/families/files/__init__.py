"""Files: hostile and broken ones."""
