"""Beams: line bodies of rigid nodes connected by elastic elements."""
