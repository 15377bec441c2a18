"""Explicit schemes by name: semi-implicit Euler, Runge-Kutta, and linearly implicit Euler, which is stable in stiff scenes."""

from __future__ import annotations

from .dop853 import DOP853
from .scheme import Scheme

EULER_CROMER = Scheme(name="euler_cromer", order=1, stages=1, c=(0, 1), a=({}, {0: 1}), semi_implicit=True)
"""u_{n+1} = u_n + h u'(q_n, u_n), q_{n+1} = q_n + h u_{n+1}. Cromer, American Journal of Physics 49 (1981) 455."""
RK4 = Scheme(
    name="rk4",
    order=4,
    stages=4,
    c=(0, 1 / 2, 1 / 2, 1, 1),
    a=({}, {0: 1 / 2}, {1: 1 / 2}, {2: 1}, {0: 1 / 6, 1: 1 / 3, 2: 1 / 3, 3: 1 / 6}),
)
"""Kutta, Z. Math. Phys. 46 (1901) 435."""
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
"""Dormand and Prince, J. Comput. Appl. Math. 6 (1980) 19; Hairer, Norsett, Wanner (see DOP853), sec. II.4 to II.6."""
LINEARLY_IMPLICIT_EULER = Scheme(name="linearly_implicit_euler", order=1, stages=1, c=(0, 1), a=({}, {0: 1}), columns=1)
"""Deuflhard, Recent progress in extrapolation methods for ordinary differential equations, SIAM Review 27 (1985) 505."""
EXTRAPOLATED_EULER = Scheme(name="extrapolated_euler", order=2, stages=1, c=(0, 1), a=({}, {0: 1}), columns=2)
"""Twice the result of two half steps, less that of a whole one: Hairer, Wanner (1996), sec. IV.9."""
SCHEMES = {
    scheme.name: scheme for scheme in (EULER_CROMER, RK4, DOPRI5, DOP853, LINEARLY_IMPLICIT_EULER, EXTRAPOLATED_EULER)
}
"""All have fixed steps but for `DOPRI5` and `DOP853`."""
