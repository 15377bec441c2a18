"""Models that are solved step by step."""
