"""Classical Runge-Kutta scheme of order 4, with fixed steps."""

from .scheme import Scheme

RK4 = Scheme(
    name="rk4",
    order=4,
    stages=4,
    c=(0, 1 / 2, 1 / 2, 1, 1),
    a=({}, {0: 1 / 2}, {1: 1 / 2}, {2: 1}, {0: 1 / 6, 1: 1 / 3, 2: 1 / 3, 3: 1 / 6}),
)
"""Kutta, Z. Math. Phys. 46 (1901) 435."""
