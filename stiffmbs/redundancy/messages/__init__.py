"""Messages on the structure of a mechanism."""
