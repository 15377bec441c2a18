"""Scripts and styles of pages, as text."""

from __future__ import annotations

from importlib.resources import files

NAMES = {"three": "three.min.js", "viewer": "viewer.js", "style": "viewer.css"}


def page_parts() -> dict[str, str]:
    """Return the scripts and styles of a page with a moving mechanism."""
    return {name: files(__package__).joinpath(file).read_text(encoding="utf-8") for name, file in NAMES.items()}
