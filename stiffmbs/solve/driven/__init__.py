"""Integration along prescribed motions, for kinematic analysis."""
