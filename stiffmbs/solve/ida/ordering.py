"""Ordering of the unknowns for a banded iteration matrix."""

from __future__ import annotations

import numpy as np

from ...compile.equations import Equations


def narrowed(equations: Equations) -> Equations:
    """Return the equations in reverse Cuthill-McKee order.

    In a chain, the unknowns of a body are then next to those of its neighbours and of the joints between them.

    Parameters
    ----------
    equations : Equations
        Equations in their natural order.

    References
    ----------
    Cuthill and McKee, Reducing the bandwidth of sparse symmetric matrices, Proc. 24th ACM Nat. Conf. (1969) 157-172.
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    n, (rows, columns) = equations.n, equations.pattern
    entries = (np.concatenate([rows, columns]), np.concatenate([columns, rows]))
    order = reverse_cuthill_mckee(csr_matrix((np.ones(2 * len(rows)), entries), shape=(n, n)), symmetric_mode=True)
    place = np.empty(n, dtype=np.int64)
    place[order] = np.arange(n)
    return equations.reordered(place)
