"""Commands for files of other programs."""
