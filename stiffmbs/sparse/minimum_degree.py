"""Minimum degree order of the nodes of a graph."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Iterator


def minimum_degree(
    neighbours: list[set[int]],
    first: Iterable[int],
    may_go: Callable[[int], bool] | None = None,
    balanced: bool = False,
) -> Iterator[tuple[int, set[int]]]:
    """Yield the nodes in the order of elimination, with the neighbours that each has then.

    The elimination of a node connects its neighbours with each other. The next node is one with the fewest neighbours: each has
    a row and a column in the factors, so that this keeps the fill-in low.

    Parameters
    ----------
    neighbours : list of set of int
        Neighbours of each node; changed.
    first : iterable of int
        Nodes that may be eliminated from the start; others may be after that of a neighbour.
    may_go : function, optional
        Return True if a node with the fewest neighbours may be eliminated; else it waits for that of a neighbour.
    balanced : bool
        Of nodes with as many neighbours, take one with the shortest sequence of pivots that depend on each other: a chain is
        eliminated from both ends, with two independent pivots at a time.

    References
    ----------
    George and Liu, The evolution of the minimum degree ordering algorithm, SIAM Review 31 (1989) 1-19.
    """
    depth = [0] * len(neighbours)
    gone = [False] * len(neighbours)
    queue = [(len(neighbours[node]), 0, node) for node in first]
    heapq.heapify(queue)
    while queue:
        degree, level, node = heapq.heappop(queue)
        # Entries from before a change of the node's neighbours are still in the queue.
        if (
            gone[node]
            or (degree, level) != (len(neighbours[node]), depth[node])
            or not (may_go is None or may_go(node))
        ):
            continue
        gone[node] = True
        around = neighbours[node]
        yield node, around
        for other in around:
            neighbours[other] |= around
            neighbours[other] -= {node, other}
            if balanced:
                depth[other] = max(depth[other], level + 1)
        for other in around:
            heapq.heappush(queue, (len(neighbours[other]), depth[other], other))
