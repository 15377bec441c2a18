"""Processor time of starts: of the program, of scenes, of first runs and of runs after an edit."""
