"""Commands on flexible bodies."""
