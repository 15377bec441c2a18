"""What a command tells on standard error while it is at work."""
