"""Fuzzers of kinks, jumps and events."""
