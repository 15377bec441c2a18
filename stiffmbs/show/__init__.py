"""Presentation of results: summaries, tables, plots, drawings, animations and pages."""
