"""Elements of an XML file, with a record of the attributes and children that a reader requests."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers.expat import ExpatError, ParserCreate

from .quoted import quoted
from .requested import Fields


class FileFault(Exception):
    """Invalid or unsupported content of a file of another program; the message names the element."""


class Node:
    """Element of an XML file.

    `kind`: tags from the root to the element without the root's own, separated by ``/``. `owner`: name of the nearest
    named element. `defaults`: values without effect, by kind. `outer`: tags that kinds omit, with all above them.
    """

    def __init__(
        self,
        element: Element,
        kind: str = "",
        owner: str = "",
        defaults: Mapping[str, Mapping[str, Any]] | None = None,
        outer: Sequence[str] = (),
    ) -> None:
        self.tag, self.attributes, self.text = element.tag, element.attrib, (element.text or "").strip()
        below, kind = f"{kind}/" if kind and element.tag not in outer else "", kind or element.tag
        children = {_child(child.tag): child.tag for child in element}
        own = {name: value for name, value in element.attrib.items() if not name.startswith("xmlns")}
        self._fields = Fields(kind, owner, {**own, **children}, (defaults or {}).get(kind))
        self._children = [
            Node(child, f"{below}{child.tag}", child.get("name") or owner, defaults, outer) for child in element
        ]

    def get(self, name: str, default: str | None = None) -> str | None:
        """Return an attribute."""
        return self._fields.get(name, default)

    def find(self, tag: str) -> Node | None:
        """Return the first child of a tag."""
        return next(iter(self.findall(tag)), None)

    def findall(self, path: str) -> list[Node]:
        """Return the children with a tag, optionally below children with another tag."""
        tag, _, rest = path.partition("/")
        self._fields.request(_child(tag))
        found = [child for child in self._children if child.tag == tag]
        return [below for child in found for below in child.findall(rest)] if rest else found

    def unrecorded(self, tag: str) -> str | None:
        """Return the text of the first child of a tag, without requesting it; None if it is missing."""
        return next((child.text for child in self._children if child.tag == tag), None)

    def among(self, *tags: str) -> list[Node]:
        """Return the children with one of several tags."""
        self._fields.request(*map(_child, tags))
        return [child for child in self._children if child.tag in tags]

    def children(self) -> list[Node]:
        """Return all children."""
        self._fields.request(*(_child(child.tag) for child in self._children))
        return self._children

    def without_effect(self, *tags: str) -> None:
        """Exclude children from the report."""
        self._fields.request(*map(_child, tags))
        self._children = [child for child in self._children if child.tag not in tags]

    def walk(self) -> Iterator[Node]:
        """Yield the element and all its descendants."""
        yield self
        for child in self._children:
            yield from child.walk()

    def fields(self) -> Iterator[Fields[str]]:
        """Yield the fields of the element and of its requested descendants."""
        yield self._fields
        unused = self._fields.unused()
        for child in self._children:
            if _child(child.tag) not in unused:
                yield from child.fields()


def _child(tag: str) -> str:
    return f"<{tag}>"


def _refuse(entity: str) -> None:
    raise FileFault(f"found the entity &{quoted(entity)}; without a value in the file")


def parsed(text: str, expected: str, defaults: Mapping[str, Mapping[str, Any]], outer: Sequence[str] = ()) -> Node:
    """Read an XML file; namespace prefixes need not be declared. Raises FileFault for text that is not well-formed.

    `defaults`, `outer`: as for `Node`.
    """
    builder, parser = TreeBuilder(), ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler = builder.start, builder.end
    parser.CharacterDataHandler = builder.data
    parser.ExternalEntityRefHandler = lambda *_: 0  # an error; without it, the text would be empty
    parser.SkippedEntityHandler = lambda name, _: _refuse(name)
    try:
        parser.Parse(text, True)
    except ExpatError as error:
        raise FileFault(f"found no well-formed XML ({error}), expected {expected}") from None
    except FileFault as fault:
        raise FileFault(f"{fault}, expected {expected}") from None
    return Node(builder.close(), defaults=defaults, outer=outer)
