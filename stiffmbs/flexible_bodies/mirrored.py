"""Mirror image of a finite element model, for bodies of mirrored parts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import diags_array

from .finite_elements import FiniteElements
from .shapes import ELEMENTS
from .solid import Solid


def mirrored(model: FiniteElements, signs: np.ndarray) -> FiniteElements:
    """Return a model whose coordinates change their signs, by the diagonal of a matrix S of shape (3,).

    Displacements u become S u, and rotations det(S) S theta.
    """
    determinant = float(np.prod(signs))
    of_node = np.concatenate([signs, determinant * signs])[: model.components]
    turn = diags_array(np.tile(of_node, len(model.nodes))).tocsr()
    nodes, cells, solid, shell = model.nodes * signs, dict(model.cells), model.solid, model.shell
    if solid is not None:
        order = {block.kind: _order(block.kind, determinant) for block in solid.blocks}
        cells |= {kind: own[:, order[kind]] for kind, own in model.solid_cells.items()}
        blocks = (replace(block, places=nodes, nodes=block.nodes[order[block.kind]]) for block in solid.blocks)
        solid = Solid(tuple(blocks))
    if shell is not None:
        shell = replace(shell, places=nodes, offsets=shell.offsets * signs)
    return replace(
        model, nodes=nodes, stiffness=turn @ model.stiffness @ turn, mass=turn @ model.mass @ turn, cells=cells, solid=solid,
        shell=shell,
    )  # fmt: skip


def _order(kind: str, determinant: float) -> np.ndarray:
    """Return the order of the nodes of an element that keeps its volume positive: two reference coordinates change places."""
    nodes = ELEMENTS[kind].nodes
    if determinant > 0.0:
        return np.arange(len(nodes))
    apart = np.linalg.norm(nodes[:, None] - nodes[:, [1, 0, 2]], axis=2)
    return np.asarray(apart.argmin(axis=0))
