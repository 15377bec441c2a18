"""Text of an .asmt file as a tree of its indented lines, with a record of the entries that a reader requests."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from ...reading.files.quoted import quoted
from ...reading.files.requested import Fields
from ..assembly import CadFault, finite

RESULTS = "TimeSeries"
"""Line after which the results of a run follow."""
DEFAULTS = {"Assembly": {"Velocity3D": "0 0 0", "Omega3D": "0 0 0"}}
"""Entries without effect by kind."""


@dataclass
class Item:
    """Line of the file with the lines below it. `kind`: labels of the lines above it and its own, from the assembly's."""

    label: str
    line: int
    kind: str = ""
    owner: str = ""
    below: list[Item] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._fields: Fields[str] = Fields(self.kind, self.owner, {})

    def close(self) -> None:
        """Record names and fields, once all lines below are read."""
        name = next((item for item in self.below if item.label == "Name"), None)
        self.owner = name.below[0].label if name is not None and name.below else self.owner
        for item in self.below:
            item.kind, item.owner = f"{self.kind}/{item.label}".removeprefix("Assembly/").removeprefix("/"), self.owner
            item.close()
        values = {item.label: " ".join(low.label for low in item.below) for item in self.below if item.below}
        self._fields = Fields(self.kind, self.owner, values, DEFAULTS.get(self.kind))

    def find(self, label: str) -> Item | None:
        """Return the entry with a label, None without one; raise CadFault if there are several."""
        self._fields.request(label)
        found = [item for item in self.below if item.label == label]
        if len(found) > 1:
            raise CadFault(f"line {found[1].line}: found {label} twice in {self.label}, expected it once")
        return found[0] if found else None

    def each(self, label: str) -> list[Item]:
        """Return the lines below an entry."""
        found = self.find(label)
        return [] if found is None else found.entries()

    def entries(self) -> list[Item]:
        """Return the lines below this one."""
        self._fields.request(*(item.label for item in self.below))
        return self.below

    def text(self, label: str, default: str | None = None) -> str:
        """Return the value of an entry, a line; raise CadFault if there is none and no default."""
        found = self.find(label)
        if found is None or len(found.below) != 1:
            if found is None and default is not None:
                return default
            raise CadFault(f"line {self.line}, {self.label}: found no value of {label}, expected a line below it")
        return found.below[0].label

    def numbers(self, label: str, shape: tuple[int, ...], default: np.ndarray | None = None) -> np.ndarray:
        """Return the numbers of an entry, of a shape; raise CadFault if there are none and no default."""
        found = self.find(label)
        if found is None and default is not None:
            return default
        text = "" if found is None else " ".join(word for item in found.below for word in item.label.split())
        try:
            values = np.array([float(word.removesuffix("d")) for word in text.split()])
        except ValueError:
            values = np.empty(0)
        if len(values) != np.prod(shape) or not np.all(np.isfinite(values)):
            line = self.line if found is None else found.line
            count = int(np.prod(shape))
            what = f"{count} numbers" if count > 1 else "a number"
            raise CadFault(f"line {line}, {label}: found '{quoted(text)}', expected {what}")
        return finite(f"line {self.line}, {label}", values).reshape(shape)

    def number(self, label: str, default: float | None = None) -> float:
        """Return the number of an entry."""
        return float(self.numbers(label, (), None if default is None else np.array(default)))

    def fields(self) -> Iterator[Fields[str]]:
        """Yield the fields of the entry and of its requested ones."""
        yield self._fields
        unused = self._fields.unused()
        for item in self.below:
            if item.below and item.label not in unused:
                yield from item.fields()


def tree(text: str) -> tuple[Item, bool]:
    """Return the assembly of a file, and whether results of a run follow it."""
    root = Item("", 0)
    above: list[tuple[int, Item]] = [(-1, root)]
    stored = False
    for number, line in enumerate(text.splitlines(), 1):
        label = line.strip()
        if label == RESULTS and not line[0].isspace():
            stored = True
            break
        if not label or label.startswith("#"):
            continue
        depth = _depth(line)
        while above[-1][0] >= depth:
            above.pop()
        item = Item(label, number)
        above[-1][1].below.append(item)
        above.append((depth, item))
    assemblies = [item for item in root.below if item.label == "Assembly"]
    if len(assemblies) != 1:
        raise CadFault(f"found {len(assemblies)} lines 'Assembly', expected one, as in a file of FreeCAD's solver")
    assembly = assemblies[0]
    assembly.kind = "Assembly"
    assembly.close()
    return assembly, stored


def _depth(line: str) -> int:
    """Return the width of the indentation, which is larger for lines below another one."""
    indent = line[: len(line) - len(line.lstrip())]
    return len(indent.expandtabs(4))
