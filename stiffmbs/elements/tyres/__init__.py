"""Magic Formula, and files of tyre properties."""
