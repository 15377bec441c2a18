"""Inputs over time: where they have features, where they end."""
