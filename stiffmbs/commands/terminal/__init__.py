"""Messages of a command on standard error during its work."""
