"""Text files, YAML, and the content of a scene before validation."""
