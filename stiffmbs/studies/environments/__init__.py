"""Environments of Gymnasium for learning controllers."""
