"""Poses at rest and steady motions in which forces balance."""
