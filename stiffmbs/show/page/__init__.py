"""Pages with a mechanism that moves: their data, and the scripts that show it."""
