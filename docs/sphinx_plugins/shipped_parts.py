"""The reference page of the parts that come with the package, made from their files."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from stiffmbs.model.parts.definitions import included_texts, shipped_part, shipped_parts, shipped_text

_PARAMETER = re.compile(r"^  (\w+): (.*?)(?: # (.*))?$")


class ShippedParts(SphinxDirective):
    """All parts, a section each: what it is, its words and mounts, and a table of its parameters."""

    def run(self) -> list[nodes.Node]:
        text = "\n".join(line for name in shipped_parts() for line in section(name))
        return self.parse_text_to_nodes(text, allow_section_headings=True)


def section(name: str) -> Iterator[str]:
    """The section of one part."""
    text = shipped_text(name)
    comment = [line[1:].strip() for line in text.split("\n") if line.startswith("#")]
    yield from (name, "-" * len(name), "", " ".join(comment).replace("`", "``"), "")
    definition = shipped_part(name) or {}
    for choice, words in (definition.get("options") or {}).items():
        yield from (f"``{choice}``: " + " or ".join(f"``{word}``" for word in words), "")
    if definition.get("mounts"):
        yield from ("``mounts``: " + ", ".join(f"``{mount}``" for mount in definition["mounts"]), "")
    yield from (".. list-table::", "   :header-rows: 1", "   :widths: 20 35 45", "")
    yield from row("parameter", "value", "what it is")
    for parameter, value, meaning in parameters(text, *included_texts(name)):
        yield from row(f"``{parameter}``", f"``{value}``", meaning)
    yield ""


def row(*cells: str) -> Iterator[str]:
    """A row of a table."""
    yield from (f"   {' ' if k else '*'} - {cell}" for k, cell in enumerate(cells))


def parameters(*texts: str) -> Iterator[tuple[str, str, str]]:
    """Name, value and comment of each parameter in the files of a part."""
    for text in texts:
        _, _, rest = text.partition("\nparameters:\n")
        for line in rest.split("\n"):
            found = _PARAMETER.match(line)
            if not found:
                break
            yield found[1], found[2], found[3] or ""


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_directive("shipped_parts", ShippedParts)
    return {"parallel_read_safe": True}
