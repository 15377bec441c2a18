"""Mechanisms as pictures: first as data that knows no output (`scene_graph`), then for a view, a page or a film."""
