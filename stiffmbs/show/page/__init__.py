"""Pages with a mechanism that moves: the data they hold, and the scripts that show it."""
