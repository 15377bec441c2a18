"""Instances of parts and subassemblies: their poses, and which of them move as one."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ...reading.files.xml_nodes import Node
from ..assembly import WORLD, CadFault, Frame, finite, rotation

FLAGS = {"true": True, "1": True, "false": False, "0": False}


@dataclass(frozen=True)
class Instance:
    """Part or subassembly in the tree of instances.

    `uids`: from the root to the instance. `label`: names along this path, unique. `entity`: uid of its part or
    assembly. `frame`: in the world. `grounded`: fixed to the frame of its assembly. `rigid`: a subassembly whose parts do
    not move. `group`: name of those instances of its assembly that move as one.
    """

    uids: tuple[str, ...]
    label: str
    entity: str
    frame: Frame
    grounded: bool
    rigid: bool
    group: str
    children: tuple[Instance, ...] = ()

    def leaves(self) -> Iterator[Instance]:
        """Yield the instances of parts."""
        if not self.children:
            yield self
        for child in self.children:
            yield from child.leaves()

    def below(self) -> Iterator[Instance]:
        """Yield the instance and all below it."""
        yield self
        for child in self.children:
            yield from child.below()

    def found(self, uids: tuple[str, ...]) -> Instance | None:
        """Return the instance at a path below this one."""
        if not uids:
            return self
        child = next((child for child in self.children if child.uids[-1] == uids[0]), None)
        return None if child is None else child.found(uids[1:])

    def carrier(self) -> Instance | None:
        """Return the part that its frame moves with; None for a subassembly that has no such part."""
        if self.rigid or not self.children:
            return next(self.leaves())
        return next((carrier for child in self.children if child.grounded and (carrier := child.carrier())), None)


def tree(root: Node, uid: str, length: float) -> Instance:
    """Return the root assembly; `length`: unit of length, m."""
    top = Instance((), "", uid, WORLD, grounded=True, rigid=False, group="")
    node = root.find("InstanceTree")
    found = replace(top, children=() if node is None else _children(node, top, length, set()))
    if not found.children:
        raise CadFault("found no instance of a part, expected <Instance> in <InstanceTree>")
    return found


def _children(node: Node, above: Instance, length: float, labels: set[str]) -> tuple[Instance, ...]:
    """Return the instances in a node; `labels`: those of the tree so far, to which theirs are added."""
    found: dict[str, Instance] = {}
    for child in node.findall("Instance"):
        uid = child.get("uid") or ""
        label = f"{above.label}/{readable(child.get('name') or uid, 'part')}".removeprefix("/")
        if not uid or uid in found:
            raise CadFault(f"instance {label}: found the uid '{uid}' twice, expected a unique one")
        while label in labels:
            label = f"{label}_{uid}"
        labels.add(label)
        where = f"instance {label}"
        frame = transform(where, child, length).on(above.frame)
        one = Instance(
            (*above.uids, uid), label, child.get("entityUid") or "", frame, _flag(where, child, "grounded"),
            _flag(where, child, "rigid"), child.get("rigidGroup") or "",
        )  # fmt: skip
        found[uid] = replace(one, children=_children(child, one, length, labels))
    return tuple(found.values())


def _flag(where: str, node: Node, name: str) -> bool:
    """Return an attribute that is true or false, as XML Schema and programs write it."""
    text = node.get(name, "false") or ""
    if text.lower() not in FLAGS:
        raise CadFault(f"{where}: found {name}='{text}', expected true or false")
    return FLAGS[text.lower()]


def readable(name: str | None, word: str) -> str:
    """Return a name; if it has no letter that a scene allows in names, a word before it."""
    return name if name and re.search("[A-Za-z]", name) else f"{word}_{name or ''}"


def transform(where: str, node: Node, length: float) -> Frame:
    """Return the frame of a <Transform>: rotation by rows, and translation."""
    given = node.find("Transform")
    if given is None:
        return WORLD
    turned = rotation(where, numbers(where, given, "Rotation", 9).reshape(3, 3))
    return Frame(numbers(where, given, "Translation", 3) * length, turned)


def numbers(where: str, node: Node, tag: str, count: int) -> np.ndarray:
    """Return the numbers in a child."""
    child = node.find(tag)
    text = "" if child is None else child.text
    try:
        found = np.array([float(word) for word in text.split()])
    except ValueError:
        found = np.empty(0)
    if len(found) != count or not np.all(np.isfinite(found)):
        what = f"{count} numbers" if count > 1 else "a number"
        raise CadFault(f"{where}: found <{tag}> '{text}', expected {what}")
    return finite(where, found)


def tied(top: Instance) -> Iterator[tuple[Instance, Instance | None]]:
    """Yield the pairs of parts that move as one, and the parts that are fixed to ground, each with None; no loops of them."""
    bodies: dict[str | None, int] = {}
    for part, other in _pairs(top):
        ends = part.label, None if other is None else other.label
        one, joined = (bodies.setdefault(label, len(bodies)) for label in ends)
        if one != joined:
            bodies |= {label: joined for label, body in bodies.items() if body == one}
            yield part, other


def loose(top: Instance) -> list[str]:
    """Return the subassemblies that are grounded, or in a rigid group, without a part that is fixed in them."""
    return [
        one.label
        for one in top.below()
        if one is not top and (one.grounded or one.group) and not one.carrier() and not _is_rigid(top, one)
    ]


def _pairs(top: Instance) -> Iterator[tuple[Instance, Instance | None]]:
    for one in top.below():
        if one is not top and one.rigid and one.children:
            first, *others = one.leaves()
            yield from ((other, first) for other in others)
        elif one.children and not _is_rigid(top, one):
            yield from _in_flexible(one, None if one is top else one.carrier())


def _is_rigid(top: Instance, one: Instance) -> bool:
    """Return True for a rigid subassembly, and for one in it."""
    within = (above for above in top.below() if one.uids[: len(above.uids)] == above.uids)
    return any(above.rigid and above.children for above in within)


def _in_flexible(one: Instance, carrier: Instance | None) -> Iterator[tuple[Instance, Instance | None]]:
    grounded = [found for child in one.children if child.grounded and (found := child.carrier())]
    yield from ((part, carrier) for part in grounded if part is not carrier)
    groups: dict[str, Instance] = {}
    for child in one.children:
        part = child.carrier()
        if child.group and part is not None:
            first = groups.setdefault(child.group, part)
            if first is not part:
                yield part, first
