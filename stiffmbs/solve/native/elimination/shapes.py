"""Products of parts of blocks, unrolled for each shape."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled
from stiffmbs.compile.machine.native.quads import add_products, take_products


@compiled
def formed(shape, into, stride, a, a_stride, b, b_stride):
    """Compute into += a^T b over three velocities; the shape is twice the lines, minus one for a single quad."""
    if shape == 10:
        add_products(5, 2, into, stride, a, a_stride, b, b_stride, 3)
    elif shape == 5:
        add_products(3, 1, into, stride, a, a_stride, b, b_stride, 3)
    elif shape == 12:
        add_products(6, 2, into, stride, a, a_stride, b, b_stride, 3)
    elif shape == 7:
        add_products(4, 1, into, stride, a, a_stride, b, b_stride, 3)
    elif shape == 9:
        add_products(5, 1, into, stride, a, a_stride, b, b_stride, 3)
    elif shape == 11:
        add_products(6, 1, into, stride, a, a_stride, b, b_stride, 3)
    elif shape == 8:
        add_products(4, 2, into, stride, a, a_stride, b, b_stride, 3)
    elif shape == 6:
        add_products(3, 2, into, stride, a, a_stride, b, b_stride, 3)
    elif shape == 4:
        add_products(2, 2, into, stride, a, a_stride, b, b_stride, 3)
    elif shape == 3:
        add_products(2, 1, into, stride, a, a_stride, b, b_stride, 3)
    elif shape == 2:
        add_products(1, 2, into, stride, a, a_stride, b, b_stride, 3)
    else:
        add_products(1, 1, into, stride, a, a_stride, b, b_stride, 3)


@compiled
def taken(shape, into, stride, a, a_stride, b, b_stride, depth):
    """Compute into -= a^T b for lines of a shape."""
    if shape == 12:
        take_products(6, 2, into, stride, a, a_stride, b, b_stride, depth)
    elif shape == 11:
        take_products(6, 1, into, stride, a, a_stride, b, b_stride, depth)
    elif shape == 10:
        take_products(5, 2, into, stride, a, a_stride, b, b_stride, depth)
    elif shape == 9:
        take_products(5, 1, into, stride, a, a_stride, b, b_stride, depth)
    elif shape == 8:
        take_products(4, 2, into, stride, a, a_stride, b, b_stride, depth)
    elif shape == 7:
        take_products(4, 1, into, stride, a, a_stride, b, b_stride, depth)
    elif shape == 6:
        take_products(3, 2, into, stride, a, a_stride, b, b_stride, depth)
    elif shape == 5:
        take_products(3, 1, into, stride, a, a_stride, b, b_stride, depth)
    elif shape == 4:
        take_products(2, 2, into, stride, a, a_stride, b, b_stride, depth)
    elif shape == 3:
        take_products(2, 1, into, stride, a, a_stride, b, b_stride, depth)
    elif shape == 2:
        take_products(1, 2, into, stride, a, a_stride, b, b_stride, depth)
    else:
        take_products(1, 1, into, stride, a, a_stride, b, b_stride, depth)
