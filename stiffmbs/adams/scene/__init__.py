"""A dataset as the mapping that a scene is read from, section by section."""
