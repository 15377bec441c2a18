"""Results of a run: channels, reactions, energies, requests, and their files."""
