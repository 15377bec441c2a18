"""What a motion means: energies and reactions."""
