"""Page with a moving mechanism only (needs jinja2, the extra ``report``)."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING

from ..escaped import page_text

if TYPE_CHECKING:
    from jinja2 import Environment


PARTS = {"three": "three.min.js", "viewer": "viewer.js", "style": "viewer.css"}


def page_parts() -> dict[str, str]:
    """Return the scripts and styles of a page with a moving mechanism."""
    return {name: files(__package__).joinpath(file).read_text(encoding="utf-8") for name, file in PARTS.items()}


def moving_page(title: str, data: dict[str, str]) -> str:
    """Return the page as HTML; it needs no network. `data`: result of `stiffmbs.show.page.data.page_data`."""
    template = environment().from_string(files(__package__).joinpath("moving.html").read_text(encoding="utf-8"))
    return template.render(title=title or "Mechanism", **data, **page_parts())


def environment() -> Environment:
    """Return the environment of templates, which escapes text for HTML and as in `stiffmbs.show.escaped`."""
    from jinja2 import Environment

    return Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, finalize=page_text)
