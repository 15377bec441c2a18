"""A page with a mechanism in motion and nothing else (needs jinja2, the extra ``report``)."""

from __future__ import annotations

from importlib.resources import files
from typing import Any

from .parts import page_parts


def moving_page(title: str, data: dict[str, str]) -> str:
    """The page as HTML; it needs no network.

    Parameters
    ----------
    title : str
    data : mapping
        Of `stiffmbs.show.page.data.page_data`.
    """
    return rendered("moving.html", title=title or "Mechanism", **data, **page_parts())


def rendered(template: str, **content: Any) -> str:
    """A template of this folder with its content; text in it is escaped."""
    from jinja2 import Environment

    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    return environment.from_string(files(__package__).joinpath(template).read_text(encoding="utf-8")).render(**content)
