"""Layout of the numbers of a flexible body: those of `BODY`, of `MODE` for each mode, and of `PAIR` by l and k.

`PAIR` has Z + W, the axial vector and the trace of Z, and T (`stiffmbs.compile.machine.native.flexible.sums`). The pairs
are followed by couplings of modes by stiffness and damping, two numbers for each pair. They are zero, and `coupled` is
0, but for other values of a parameter, whose modes are referred to those of its own value; then `coupled` is the number
of modes. The last are `known` vectors b_i of the stretch of second order, each with its matrix Gamma_i by rows;
`stretch` is the number of these in the equations, `known` or zero (`stiffmbs.compile.machine.native.flexible.elastic`). `stiffened`
is 1 with geometric stiffness, 0 if it is left out, and -1 for a body that has none.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

BODY = {
    "gravity": 3, "d0": 3, "X": 9, "moments": 3, "modal_mass": 1, "stretch": 1, "known": 1, "stiffened": 1, "coupled": 1,
}  # fmt: skip
MODE = {"stiffness": 1, "damping": 1, "S": 3, "Y": 9}
PAIR = {"ZW": 9, "axial": 3, "trace": 1, "T": 3}
COUPLING = 2
"""Names and lengths of consecutive numbers."""
MODES, OF_MODE, OF_PAIR = sum(BODY.values()), sum(MODE.values()), sum(PAIR.values())
"""Number of the first mode, and numbers of each mode and pair."""


def work_size(n: int) -> int:
    """Return the number of doubles that kernels use for n modes: for elastic forces, and for sums over one mode of pairs."""
    return 7 * n + 2 * n * n + 3 * OF_PAIR * n


def parts(numbers: np.ndarray, n: int) -> dict[str, np.ndarray]:
    """Return the numbers of a body with n modes by their names, in arrays of shape (modes, modes, length).

    Vectors b_i are ``static``, shape (known, n), and the matrices Gamma_i ``Gamma``, shape (known, n, n).
    """
    found: dict[str, np.ndarray] = {}
    first = 0
    shapes: tuple[tuple[Mapping[str, int], tuple[int, ...]], ...] = ((BODY, ()), (MODE, (n,)), (PAIR, (n, n)))
    for names, shape in shapes:
        size = sum(names.values())
        block = numbers[first : first + size * n ** len(shape)].reshape(*shape, size)
        first += block.size
        found |= dict(zip(names, np.split(block, np.cumsum(list(names.values()))[:-1], axis=-1), strict=True))
    first += 2 * n * n
    known = int(found["known"][0])
    stretch = numbers[first : first + known * n * (n + 1)].reshape(known, n + 1, n)
    return found | {"static": stretch[:, 0], "Gamma": stretch[:, 1:]}
