"""Independent static solver for the fuzzers."""
