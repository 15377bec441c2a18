"""Compiled loops of beam sections whose strain is interpolated between several nodes."""
