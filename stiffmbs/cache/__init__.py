"""What is kept on disk from one run to the next, bound to its user."""
