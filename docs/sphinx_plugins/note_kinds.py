"""The reference page of notes, made from the kinds that the modules of the package declare and the reasons of early ends."""

from __future__ import annotations

import importlib
import pkgutil
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import stiffmbs
from stiffmbs.notes import NoteKind, Severity
from stiffmbs.solve.reasons import Reason

if TYPE_CHECKING:
    from docutils import nodes
    from sphinx.application import Sphinx

_FIELD = re.compile(r"\{(\w+)(?::[^{}]*)?\}")
"""Field of a text, with a format for numbers."""


def note_kinds() -> dict[str, NoteKind]:
    """All kinds of notes, by the modules and names that declare them, in the order of both."""
    modules = [name for _, name, _ in pkgutil.walk_packages(stiffmbs.__path__, "stiffmbs.") if "__main__" not in name]
    return {
        f"{module}.{name}": kind
        for module in sorted(modules)
        for name, kind in vars(importlib.import_module(module)).items()
        if isinstance(kind, NoteKind)
    }


def page(kinds: dict[str, NoteKind]) -> Iterator[str]:
    """The sections: what a severity means, and a table of its kinds."""
    for severity in (Severity.DOUBT, Severity.WARNING, Severity.REMARK):
        title = f"{severity.name.capitalize()}s"
        yield from (title, "-" * len(title), "", f"{severity.value.capitalize()}.", "")
        yield from (".. list-table::", "   :header-rows: 1", "   :widths: 17 45 23 15", "")
        yield from row("kind", "note", "what to do", "module")
        found = {kind.name: (kind, place) for place, kind in kinds.items() if kind.severity is severity}
        for name, (kind, place) in sorted(found.items()):
            yield from row(f"``{name}``", *words(kind), f"``{place.split('.', 1)[1].rpartition('.')[0]}``")
        yield ""
    yield from (
        "Early ends",
        "----------",
        "",
        f"{Severity.STOP.value.capitalize()}. ``solution.ended`` has these kinds.",
        "",
    )
    yield from (".. list-table::", "   :header-rows: 1", "   :widths: 20 40 40", "")
    yield from row("kind", "reason", "what to do")
    for reason in Reason:
        yield from row(f"``{reason.of('').kind}``", reason.what, reason.remedy)
    yield ""


def words(kind: NoteKind) -> tuple[str, str]:
    """The text and the remedy of a kind, with its fields in italics."""
    text = kind.text.replace("{remedy}", kind.remedy)
    return tuple(  # type: ignore[return-value]
        re.sub(r"([*`|\\_])", r"\\\1", _FIELD.sub("<\\1>", part).replace("{{", "{").replace("}}", "}"))
        for part in (text, kind.remedy)
    )


def row(*cells: str) -> Iterator[str]:
    """A row of a table."""
    yield from (f"   {' ' if k else '*'} - {cell}" for k, cell in enumerate(cells))


def setup(app: Sphinx) -> dict[str, Any]:
    from sphinx.util.docutils import SphinxDirective  # the tests read the tables without Sphinx

    class NoteKinds(SphinxDirective):
        """All kinds of notes, a section for each severity."""

        def run(self) -> list[nodes.Node]:
            return self.parse_text_to_nodes("\n".join(page(note_kinds())), allow_section_headings=True)

    app.add_directive("note_kinds", NoteKinds)
    return {"parallel_read_safe": True}
