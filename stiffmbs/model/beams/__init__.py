"""Beams: line bodies that stand for rigid nodes joined by elastic elements."""
