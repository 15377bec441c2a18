"""Spanning tree of the links of a file, from the world outwards; the other joints close loops."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from .joints import Arc


@dataclass(frozen=True)
class Branch:
    """Link with the joint that carries it; None for a link that moves freely. `reverse`: it is the joint's parent."""

    link: str
    arc: Arc | None = None
    reverse: bool = False

    @property
    def carrier(self) -> str | None:
        """Link at the other end of the joint; None for the world."""
        if self.arc is None:
            return None
        return self.arc.child if self.reverse else self.arc.parent


def spanning_tree(links: Sequence[str], fixed: Iterable[str], arcs: Sequence[Arc]) -> Iterator[Branch]:
    """Yield the links that are not fixed, each after its carrier.

    Links are first carried by joints whose child they are. A joint carries its parent only if no other joint does.
    """
    from_parent, from_child = _by_end(arcs, "parent"), _by_end(arcs, "child")
    reached: dict[str | None, None] = dict.fromkeys([None, *fixed])
    outwards, backwards = list(reached), list(reached)
    children = {arc.child for arc in arcs}
    left = iter([*(link for link in links if link not in children), *links])
    while True:
        found = _next(outwards, from_parent, reached, False) or _next(backwards, from_child, reached, True)
        if found is None:
            free = next((link for link in left if link not in reached), None)
            if free is None:
                return
            found = Branch(free)
        reached[found.link] = None
        outwards.append(found.link)
        backwards.append(found.link)
        yield found


def _by_end(arcs: Sequence[Arc], end: str) -> dict[str | None, list[Arc]]:
    found: dict[str | None, list[Arc]] = {}
    for arc in arcs:
        found.setdefault(getattr(arc, end), []).append(arc)
    return found


def _next(
    waiting: list[str | None], by_end: dict[str | None, list[Arc]], reached: dict[str | None, None], reverse: bool
) -> Branch | None:
    """Return a link next to a reached one; reached links without any are removed from `waiting`."""
    while waiting:
        for arc in by_end.get(waiting[0], ()):
            link = arc.parent if reverse else arc.child
            if link is not None and link not in reached:
                return Branch(link, arc, reverse)
        waiting.pop(0)
    return None
