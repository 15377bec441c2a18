"""Beams and a reduced flexible body, as they are put to other tools."""
