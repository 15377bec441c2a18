"""Decisions on what follows a run: its verification, and its evaluation."""
