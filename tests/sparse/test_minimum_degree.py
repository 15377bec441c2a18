"""The minimum degree order: no fill-in in trees, chains from both ends, little fill-in in grids."""

import itertools

import pytest

from stiffmbs.sparse.minimum_degree import minimum_degree


def graph(count, edges):
    found = [set() for _ in range(count)]
    for a, b in edges:
        found[a].add(b)
        found[b].add(a)
    return found


def tree(count):
    return graph(count, [(k, (k - 1) // 3) for k in range(1, count)])


def fill_of(neighbours, order):
    """Return the number of entries that the elimination adds to a symmetric matrix, by its rows."""
    rows = [set(row) for row in neighbours]
    added = 0
    for k, node in enumerate(order):
        later = [other for other in rows[node] if other in order[k + 1 :]]
        for a, b in itertools.combinations(later, 2):
            added += b not in rows[a]
            rows[a].add(b)
            rows[b].add(a)
    return added


@pytest.mark.parametrize("balanced", [False, True])
def test_a_tree_fills_nothing(balanced):
    order = [node for node, _ in minimum_degree(tree(40), range(40), balanced=balanced)]
    assert sorted(order) == list(range(40))
    assert fill_of(tree(40), order) == 0


def test_a_chain_is_eliminated_from_both_ends():
    chain = graph(7, itertools.pairwise(range(7)))
    assert [node for node, _ in minimum_degree(chain, range(7), balanced=True)] == [0, 6, 1, 5, 2, 4, 3]


def test_a_grid_fills_less_than_by_rows():
    side = 8
    edges = [(k, k + 1) for k in range(side**2) if (k + 1) % side] + [(k, k + side) for k in range(side * (side - 1))]
    grid = graph(side**2, edges)
    order = [node for node, _ in minimum_degree(graph(side**2, edges), range(side**2))]
    assert fill_of(grid, order) < fill_of(grid, list(range(side**2))) * 0.6


def test_the_neighbours_are_those_at_the_elimination():
    """Of a ring each node has two neighbours until three are left."""
    ring = graph(6, [(k, (k + 1) % 6) for k in range(6)])
    found = [(node, set(around)) for node, around in minimum_degree(ring, range(6))]
    assert [len(around) for _, around in found] == [2, 2, 2, 2, 1, 0]


def test_a_node_waits_until_it_may_go_and_is_asked_again_after_each_neighbour():
    """The middle of a star may go after two of its four ends; nothing asks for it before the first of them has gone."""
    star, gone, asked = graph(5, [(4, k) for k in range(4)]), [], []

    def may_go(node):
        if node == 4:
            asked.append(len(gone))
        return node != 4 or len(gone) >= 2

    for node, _ in minimum_degree(star, range(4), may_go):
        gone.append(node)
    assert asked[0] >= 1 and gone[:2] == [0, 1] and sorted(gone) == list(range(5))
