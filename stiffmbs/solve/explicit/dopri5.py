"""The scheme of order 5 of Dormand and Prince, error estimate of order 4, interpolant of order 4."""

from .scheme import Scheme

DOPRI5 = Scheme(
    name="dopri5",
    order=5,
    stages=6,
    c=(0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1, 1),
    a=(
        {},
        {0: 1 / 5},
        {0: 3 / 40, 1: 9 / 40},
        {0: 44 / 45, 1: -56 / 15, 2: 32 / 9},
        {0: 19372 / 6561, 1: -25360 / 2187, 2: 64448 / 6561, 3: -212 / 729},
        {0: 9017 / 3168, 1: -355 / 33, 2: 46732 / 5247, 3: 49 / 176, 4: -5103 / 18656},
        {0: 35 / 384, 2: 500 / 1113, 3: 125 / 192, 4: -2187 / 6784, 5: 11 / 84},
    ),
    errors=({0: 71 / 57600, 2: -71 / 16695, 3: 71 / 1920, 4: -17253 / 339200, 5: 22 / 525, 6: -1 / 40},),
    dense=(
        {
            0: -12715105075 / 11282082432, 2: 87487479700 / 32700410799, 3: -10690763975 / 1880347072,
            4: 701980252875 / 199316789632, 5: -1453857185 / 822651844, 6: 69997945 / 29380423,
        },
    ),
    exponent=0.2,
    memory=0.04,
    stability=3.25,
)  # fmt: skip
"""Dormand and Prince, J. Comput. Appl. Math. 6 (1980) 19; interpolant, step control and limit of stability as in
Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I (2nd ed. 1993), ch. II.4 to II.6 and the code DOPRI5."""
