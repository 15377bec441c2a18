"""Independent static equilibria for the fuzzers."""
