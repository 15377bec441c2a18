"""What comes out of a run: channels, reactions, energies, requests, and the files that hold them."""
