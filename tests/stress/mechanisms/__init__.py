"""Mechanisms with published or closed-form results."""
