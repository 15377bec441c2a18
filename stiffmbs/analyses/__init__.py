"""Analyses of a model: checks, runs, equilibria, linearisation."""
