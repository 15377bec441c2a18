"""Drawings of mechanisms: as data independent of any output (`scene_graph`), then for a view, a page or a film."""
