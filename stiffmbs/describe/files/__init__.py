"""Text files, YAML, and what stands in a scene before it is validated."""
