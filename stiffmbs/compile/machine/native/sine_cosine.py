"""Sines and cosines of four angles at once, accurate to one unit in the last place.

The angle is reduced to an eighth of a turn with the rounding error of the reduction (Cody and Waite, Software Manual
for the Elementary Functions, 1980, ch. 8). The polynomials are those of Sun's fdlibm (k_sin.c, k_cos.c).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi

from .access import compiled
from .quads import item_of, nearest_whole, plus_product, product_of, quad_of, spread

FARTHEST = 1e5
"""Largest angle for which two parts of pi/2 suffice, rad."""
QUARTER = pi / 2
QUARTER_REST = cos(QUARTER)
"""Two parts of pi/2, rad: its rounded value, and the rest."""
PER_QUARTER = 1 / QUARTER


@dataclass(frozen=True)
class Polynomial:
    """Coefficients of a polynomial in the square of the angle."""

    c1: float
    c2: float
    c3: float
    c4: float
    c5: float
    c6: float


SINE = Polynomial(
    -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04,
    2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10,
)  # fmt: skip
COSINE = Polynomial(
    4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05,
    -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11,
)  # fmt: skip


@compiled
def _values(p, z):
    """Evaluate a polynomial at four squares."""
    s = plus_product(spread(p.c4), z, plus_product(spread(p.c5), z, spread(p.c6)))
    return plus_product(spread(p.c1), z, plus_product(spread(p.c2), z, plus_product(spread(p.c3), z, s)))


@compiled
def share_four(q, turned, turn):
    """Store cosines and sines of four bodies, given by first coordinates; return False for large angles."""
    i, j, k, m = turned[0], turned[1], turned[2], turned[3]
    a, b, c, d = q[i + 2], q[j + 2], q[k + 2], q[m + 2]
    if not (max(abs(a), abs(b)) <= FARTHEST and max(abs(c), abs(d)) <= FARTHEST):
        return False
    x, one, minus = quad_of(a, b, c, d), spread(1.0), spread(-1.0)
    quarters = nearest_whole(product_of(x, spread(PER_QUARTER)))
    back = product_of(quarters, minus)
    near = plus_product(x, back, spread(QUARTER))
    y = plus_product(near, back, spread(QUARTER_REST))
    rest = plus_product(plus_product(near, y, minus), back, spread(QUARTER_REST))
    z = product_of(y, y)

    sine = plus_product(y, plus_product(rest, product_of(z, y), _values(SINE, z)), one)
    most = plus_product(one, z, spread(-0.5))
    lost = plus_product(plus_product(one, most, minus), z, spread(-0.5))
    lost = plus_product(plus_product(lost, product_of(z, z), _values(COSINE, z)), product_of(y, rest), minus)
    cosine = plus_product(most, lost, one)

    half = nearest_whole(plus_product(spread(-0.25), quarters, spread(0.5)))
    quarter = nearest_whole(plus_product(spread(-0.25), half, spread(0.5)))
    odd, turned_over = plus_product(quarters, half, spread(-2.0)), plus_product(half, quarter, spread(-2.0))
    even, sign = plus_product(one, odd, minus), plus_product(one, turned_over, spread(-2.0))
    sines = product_of(sign, plus_product(product_of(even, sine), odd, cosine))
    cosines = product_of(sign, plus_product(product_of(even, cosine), product_of(odd, minus), sine))
    turn[i], turn[i + 1] = item_of(cosines, 0), item_of(sines, 0)
    turn[j], turn[j + 1] = item_of(cosines, 1), item_of(sines, 1)
    turn[k], turn[k + 1] = item_of(cosines, 2), item_of(sines, 2)
    turn[m], turn[m + 1] = item_of(cosines, 3), item_of(sines, 3)
    return True
