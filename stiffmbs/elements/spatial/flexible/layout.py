"""Layout of the numbers of a flexible body with n modal coordinates.

Rows of n numbers are followed by zeros up to `width`, a multiple of four (SIMD). The parts, one after the other:

- the numbers of `BODY`
- rows of `MODE` by mode k
- for each mode l, rows of `PAIR` by mode k: of Z + W, the axial vector of Z, and T
- n rows of the modal mass matrix, less its diagonal part
- n rows each of the couplings of modes by stiffness and by damping. They are zero, and `coupled` is 0, except for other
  values of a parameter, whose modes are referred to those of its own value; then `coupled` is n
- `known` rows b_i of the stretch of second order, then for each mode l the rows l of the matrices Gamma_i

The symmetric part of a matrix N, such as Z + W, has six numbers: N_xx, N_yy, N_zz, N_yz + N_zy, N_zx + N_xz and
N_xy + N_yx. Its axial vector is N_yz - N_zy, N_zx - N_xz, N_xy - N_yx. `stretch` is the number of stretches in the
equations, `known` or zero. `stiffened` is 1 with geometric stiffness, 0 if it is left out, and -1 for a body that has
none. The terms are explained in `stiffmbs.compile.machine.flexible.sums`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Final

import numpy as np

BODY = {
    "gravity": 3, "d0": 3, "X": 6, "moments": 3, "modal_mass": 1, "stretch": 1, "known": 1, "stiffened": 1, "coupled": 1,
}  # fmt: skip
MODE = {"Y_symmetric": 6, "Y_axial": 3, "S": 3, "stiffness": 1, "damping": 1}
PAIR = {"symmetric": 6, "axial": 3, "T": 3, "of_Z": 3}
COUPLINGS: Final = 2
"""Names and lengths of consecutive numbers or rows."""
MODES, OF_MODE, OF_PAIR = sum(BODY.values()), sum(MODE.values()), sum(PAIR.values())
"""Number of the first mode, and rows of each mode and pair."""
ROW_OF_MODE, ROW_OF_PAIR = (
    {name: sum(list(rows.values())[:k]) for k, name in enumerate(rows)} for rows in (MODE, PAIR)
)
"""First row of each part."""
QUAD: Final = 4
"""Numbers of a SIMD vector."""


def width(n: int) -> int:
    """Return the length of a row of n numbers with its zeros."""
    return -(-n // QUAD) * QUAD


def work_size(n: int) -> int:
    """Return the number of doubles that kernels use for n modes (`stiffmbs.compile.machine.flexible.sums`)."""
    return width(n) * (34 + 2 * n) + 24


def components(N: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the symmetric part and the axial vector of matrices in the last two axes, shapes (..., 6) and (..., 3)."""
    around = ((1, 2), (2, 0), (0, 1))
    diagonal = [N[..., i, i] for i in range(3)]
    return (
        np.stack([*diagonal, *(N[..., i, j] + N[..., j, i] for i, j in around)], axis=-1),
        np.stack([N[..., i, j] - N[..., j, i] for i, j in around], axis=-1),
    )


def parts(numbers: np.ndarray, n: int) -> dict[str, np.ndarray]:
    """Return views of the numbers of a body with n modes by their names.

    Numbers of modes have the shape (n, length), those of pairs (n, n, length). ``mass`` is the modal mass matrix less
    its diagonal part, shape (n, n), and ``coupling`` has the shape (2, n, n). Vectors b_i are ``static``, shape
    (known, n), and the matrices Gamma_i ``Gamma``, shape (known, n, n).
    """
    row = width(n)
    found = dict(_named(numbers[:MODES], BODY))
    known = int(found["known"][0])
    of_modes, of_pairs, mass, coupling, static, Gamma = (
        block.reshape(*shape, row)[..., :n]
        for block, shape in _blocks(
            numbers[MODES:], row, [(OF_MODE,), (n, OF_PAIR), (n,), (COUPLINGS, n), (known,), (n, known)]
        )
    )
    found |= dict(_named(of_modes.T, MODE))
    found |= dict(_named(of_pairs.swapaxes(1, 2), PAIR))
    return found | {"mass": mass, "coupling": coupling, "static": static, "Gamma": Gamma.swapaxes(0, 1)}


def numbers_of(values: Mapping[str, Any], n: int) -> np.ndarray:
    """Return the numbers of a body with n modes from values by the names of `parts`."""
    known = int(values["known"])
    rows = OF_MODE + n * (OF_PAIR + 1 + COUPLINGS) + known * (1 + n)
    numbers = np.zeros(MODES + width(n) * rows)
    dict(_named(numbers, BODY))["known"][:] = known
    for name, view in parts(numbers, n).items():
        view[...] = values[name]
    return numbers


def _named(numbers: np.ndarray, lengths: Mapping[str, int]) -> Iterator[tuple[str, np.ndarray]]:
    """Yield consecutive parts of the last axis with their names."""
    first = 0
    for name, length in lengths.items():
        yield name, numbers[..., first : first + length]
        first += length


def _blocks(
    numbers: np.ndarray, row: int, shapes: list[tuple[int, ...]]
) -> Iterator[tuple[np.ndarray, tuple[int, ...]]]:
    """Yield consecutive blocks of rows with their shapes."""
    first = 0
    for shape in shapes:
        size = row * int(np.prod(shape))
        yield numbers[first : first + size], shape
        first += size
