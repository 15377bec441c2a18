"""Parse reStructuredText in pages of either format."""

from __future__ import annotations

from pathlib import Path

from docutils import nodes
from sphinx.util.docutils import SphinxDirective


def nodes_of(directive: SphinxDirective, text: str, allow_section_headings: bool = False) -> list[nodes.Node]:
    """Return the nodes of a reStructuredText that a directive makes, on pages in Markdown too."""
    if Path(directive.env.doc2path(directive.env.docname)).suffix == ".md":
        text = f"`````{{eval-rst}}\n{text}\n`````\n"
    return directive.parse_text_to_nodes(text, allow_section_headings=allow_section_headings)
