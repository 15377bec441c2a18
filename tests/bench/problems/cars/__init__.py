"""Benchmark problems about cars on their manoeuvres."""
