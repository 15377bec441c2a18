"""Page with a moving mechanism only (needs jinja2, the extra ``report``)."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING, Any

from ..escaped import page_text
from .parts import page_parts

if TYPE_CHECKING:
    from jinja2 import Environment


def moving_page(title: str, data: dict[str, str]) -> str:
    """Return the page as HTML; it needs no network.

    Parameters
    ----------
    title : str
    data : mapping
        Result of `stiffmbs.show.page.data.page_data`.
    """
    return rendered("moving.html", title=title or "Mechanism", **data, **page_parts())


def environment() -> Environment:
    """Return the environment of templates, which escapes text for HTML and as in `stiffmbs.show.escaped`."""
    from jinja2 import Environment

    return Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, finalize=page_text)


def rendered(template: str, **content: Any) -> str:
    """Return a rendered template of this folder, with escaped text."""
    return (
        environment().from_string(files(__package__).joinpath(template).read_text(encoding="utf-8")).render(**content)
    )
