"""What was found about the structure of a mechanism, in sentences."""
