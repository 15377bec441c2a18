"""Stress tests of elements that users define."""
