"""Origin of results on pages and in the metadata of figures."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from ..reading.files.yaml_text import read_yaml
from .escaped import escaped

if TYPE_CHECKING:
    from ..results.provenance import Provenance

END = "</body>"


def page_with_origin(page: str, origin: Provenance | None, text: str = "") -> str:
    """Return an HTML page with the scene that was solved, its changes, command line, version and date at its end.

    `text`: text of the scene's file, which is shown if it is the scene that was solved.
    """
    if origin is None:
        return page
    before, end, after = page.rpartition(END)
    return f"{before}{origin_section(origin, text)}{end}{after}"


def origin_section(origin: Provenance, text: str = "") -> str:
    """Return the folded section of a page with its scene and command; `text` as for `page_with_origin`."""
    lines = [f"stiffmbs {origin.version}, {origin.date}", origin.command, *(origin.changes or ("no changes",))]
    scene = text if _is_of(text, origin) else origin.scene_text
    return (
        '<details id="origin"><summary><h2>Scene and command of this page</h2></summary>\n'
        f'<pre style="white-space: pre-wrap">{_escaped(chr(10).join(lines))}</pre>\n'
        f'<pre style="overflow-x: auto">{_escaped(scene)}</pre></details>\n'
    )


def figure_metadata(path: Path, origin: Provenance | None) -> dict[str, str | None] | None:
    """Return the metadata of a figure by the names of its format; no time of its own in .svg, so that it is reproducible."""
    own: dict[str, str | None] = {"Date": None} if path.suffix == ".svg" else {}
    if origin is not None:
        own |= {"Subject" if path.suffix == ".pdf" else "Description": origin.as_json()}
    return own or None


def _is_of(text: str, origin: Provenance) -> bool:
    """Return True if a text is the scene that was solved."""
    if origin.changes or not text:
        return False
    try:
        return bool(read_yaml(text, "scene") == origin.scene)
    except InputError:
        return False


def _escaped(text: str) -> str:
    return escape(escaped(text))
