"""Reference pages made from the classes: every kind of joint and force, every described class, the Python interface.

Directives: ``kinds`` and ``overview`` (``joints``, ``forces``, or those of space, ``spatial.joints`` ...), ``fields`` (a described
class), ``interface`` (names of a module: a table, and their documentation).  A new kind appears by its existence.
"""

from __future__ import annotations

import importlib
import inspect
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from textwrap import dedent, indent
from typing import Any

from as_rst import nodes_of
from docutils import nodes
from fields import field_table
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

import stiffmbs
from stiffmbs.elements.element import Element, Force, Joint
from stiffmbs.model import model
from stiffmbs.model import spatial_model as spatial_model
from stiffmbs.reading.fields import Described

SECTIONS = {
    "joints": ("stiffmbs", model.JOINTS),
    "forces": ("stiffmbs", model.FORCES),
    "spatial.joints": ("stiffmbs.spatial", spatial_model.JOINTS),
    "spatial.forces": ("stiffmbs.spatial", spatial_model.FORCES),
}
"""The module that offers the classes, and the classes by kind."""
EQUATIONS = {
    Joint: ("relation", "position", "velocity", "displacement", "angle"),
    Force: ("law", "efforts", "powers", "potential"),
}


INNER = "body_type, data_type, handle_type, kinds"
"""What models are made of."""


class Kinds(SphinxDirective):
    """All kinds of joints or forces, a section each, in groups: a line of content is ``Title: kind kind ...``.

    What no line names comes last, so that a new kind needs no line.
    """

    required_arguments = 1
    has_content = True

    def run(self) -> list[nodes.Node]:
        module, kinds = SECTIONS[self.arguments[0]]
        groups = {title: names.split() for title, _, names in (line.partition(": ") for line in self.content if line)}
        named = [kind for group in groups.values() for kind in group]
        if wrong := sorted({kind for kind in named if kind not in kinds or named.count(kind) > 1}):
            raise self.error(f"found {', '.join(wrong)}, expected kinds of {self.arguments[0]}, each once")
        groups["Other"] = sorted(set(kinds) - set(named))
        text = "\n".join(line for title, group in groups.items() if group for line in self._group(module, title, group))
        return nodes_of(self, text, allow_section_headings=True)

    def _group(self, module: str, title: str, group: list[str]) -> Iterator[str]:
        kinds = SECTIONS[self.arguments[0]][1]
        yield from ("", title, "-" * len(title), "")
        for kind in group:
            yield from section(module, kind, kinds[kind])


class Overview(SphinxDirective):
    """A table of all kinds of joints or forces, a row each."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        return nodes_of(self, "\n".join(overview(*SECTIONS[self.arguments[0]])))


class Fields(SphinxDirective):
    """The class of a description, with its fields."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        module, _, name = self.arguments[0].rpartition(".")
        described = getattr(importlib.import_module(module), name)
        return nodes_of(self, "\n".join(field_table(described)))


class Interface(SphinxDirective):
    """Names of a module: a table with the first sentence of each, and their documentation."""

    required_arguments = 1
    has_content = True

    def run(self) -> list[nodes.Node]:
        module = self.arguments[0]
        names = " ".join(self.content).split()
        text = "\n".join([*summaries(module, names), *(line for name in names for line in documented(module, name))])
        return nodes_of(self, text)


def summaries(module: str, names: list[str]) -> Iterator[str]:
    """The table of some names of a module."""
    yield from (".. list-table::", "   :widths: 30 70", "")
    for name in names:
        words = inspect.cleandoc(getattr(importlib.import_module(module), name).__doc__ or "").split("\n\n")[0]
        yield from (f"   * - :py:obj:`~{module}.{name}`", f"     - {' '.join(words.split())}")
    yield ""


def documented(module: str, name: str) -> Iterator[str]:
    """The directives for one exported name."""
    thing = getattr(importlib.import_module(module), name)
    if inspect.isclass(thing):
        yield f".. autoclass:: {module}.{name}"
        if module != "stiffmbs" and getattr(stiffmbs, name, None) is thing:
            yield "   :no-index:"
        if not issubclass(thing, Described | Exception):
            yield from (
                "   :members:",
                "   :inherited-members: Mapping, Env, VectorEnv",
                f"   :exclude-members: {INNER}",
            )
        yield ""
        if issubclass(thing, Described) and thing.model_fields.keys() - {"type"}:
            yield from field_table(thing)
    elif callable(thing):
        yield from (f".. autofunction:: {module}.{name}", "")
    else:
        yield from (f".. py:data:: {module}.{name}", f"   :value: {thing!r}", "")


def overview(module: str, kinds: Mapping[str, type[Element]]) -> Iterator[str]:
    """The table: what each kind is, its fields (those with a default in brackets), and the equations of joints."""
    titles = (
        "type",
        "what it is",
        "fields",
        *(["equations"] if kinds is SECTIONS["joints"][1] or kinds is SECTIONS["spatial.joints"][1] else []),
    )
    yield from (".. list-table::", "   :header-rows: 1", "")
    rows = (_row(module, kind, element) for kind, element in kinds.items())
    for row in (titles, *(row[: len(titles)] for row in rows)):
        yield from (f"   {'*' if k == 0 else ' '} - {cell}" for k, cell in enumerate(row))
    yield ""


def _row(module: str, kind: str, element: type[Element]) -> tuple[str, ...]:
    fields = [
        (field.alias or name, field.is_required()) for name, field in element.model_fields.items() if name != "type"
    ]
    needed = " ".join(name for name, required in fields if required)
    others = " ".join(name for name, required in fields if not required)
    words = inspect.cleandoc(element.__doc__ or "").split("\n\n")[0].replace("\n", " ")
    first = words.split(":  ")[0]
    listed = " ".join(([f"``{needed}``"] if needed else []) + ([f"[``{others}``]"] if others else []))
    equations = " ".join(getattr(element, "equations", ()))
    return f":ref:`{kind} <{module}.{kind}>` (``{kind}``)", first, listed, f"``{equations}``" if equations else ""


def section(module: str, kind: str, element: type[Element]) -> Iterator[str]:
    """The section of one kind: its class, names of equations, fields, and its equations as they stand in the source."""
    yield from (f".. _{module}.{kind}:", "", kind, "~" * len(kind), "")
    if element.__module__.partition(".")[0] != "stiffmbs":
        module = element.__module__
    shared = module != "stiffmbs" and element in SECTIONS["joints"][1].values()
    yield from (f".. autoclass:: {module}.{element.__name__}", *(["   :no-index:"] if shared else []), "")
    yield from _sketched(module, kind, element)
    if names := getattr(element, "equations", ()):
        yield from ("Equations: " + ", ".join(f"``{name}``" for name in names), "")
    yield from field_table(element)
    yield from ("In the source, ``e`` being the element with frames for its markers and symbols for its numbers:", "")
    yield from (".. code-block:: python", "", indent("\n\n".join(sources(element)), "   "), "")


def _sketched(module: str, kind: str, element: type[Element]) -> Iterator[str]:
    """A drawing of the kind between two bodies; none for equations, which have no place, and for kinds without a form."""
    if element.__module__.startswith("stiffmbs") and not kind.endswith("equation") and getattr(element, "forms", True):
        yield from (".. plot::", "   :include-source: false", f"   :alt: sketch of {kind}", "")
        yield from (
            "   from sketches import sketch",
            f"   sketch({3 if module == 'stiffmbs.spatial' else 2}, '{kind}')",
            "",
        )


def sources(element: type[Element]) -> Iterator[str]:
    """The methods in which a class writes its equations."""
    ((base, names),) = ((base, names) for base, names in EQUATIONS.items() if issubclass(element, base))
    for name in names:
        own, inherited = (inspect.getattr_static(owner, name, None) for owner in (element, base))
        is_coordinate = name in ("displacement", "angle")
        if own is not inherited and not (is_coordinate and name not in element.free_coordinates()):  # type: ignore[attr-defined]
            source = dedent(inspect.getsource(getattr(element, name)))
            yield source.removeprefix("@staticmethod\n").removeprefix("@classmethod\n").rstrip()


LONGEST_SIGNATURE = 160
"""Characters of a signature, two lines of a page."""


def short_signature(
    app: Sphinx, what: str, name: str, thing: Any, options: Any, signature: str | None, returned: str | None
) -> tuple[str | None, str | None]:
    """Leave out the fields of described classes, which the table has, and the last keywords of long signatures."""
    if inspect.isclass(thing) and issubclass(thing, Described):
        return "", None
    if signature is None or len(signature) <= LONGEST_SIGNATURE:
        return signature, returned
    kept, _, _ = signature[:LONGEST_SIGNATURE].rpartition(", ")
    return f"{kept}, ...)", returned


def write_schema(app: Sphinx, error: Exception | None) -> None:
    """Put the JSON schema of scenes next to the pages, for editors."""
    if error is None and app.builder.format == "html":
        Path(app.outdir, "scene.schema.json").write_text(
            json.dumps(stiffmbs.scene_schema(), indent=2), encoding="utf-8"
        )


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_directive("kinds", Kinds)
    app.add_directive("overview", Overview)
    app.add_directive("fields", Fields)
    app.add_directive("interface", Interface)
    app.connect("autodoc-process-signature", short_signature)
    app.connect("build-finished", write_schema)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
