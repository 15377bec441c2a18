"""J M^-1 J^T by dense blocks: one for each joint, and one for two joints of a body.

Joints are eliminated in a fixed order (`stiffmbs.solve.linear.joint_blocks`).  For trees, the cost is linear in the
number of joints, as for the articulated-body algorithm (Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 7).
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, shifted, view_of
from stiffmbs.compile.machine.native.node_factors import (
    complete_vector,
    eliminate_node,
    eliminate_rows,
    eliminate_vector,
    factor_symmetric,
)
from stiffmbs.compile.machine.native.quads import (
    plus_product,
    quad,
    set_quad,
    spread,
    sum_of,
    take_products,
)
from stiffmbs.solve.native.elimination.digits import keeps_digits
from stiffmbs.solve.native.elimination.shapes import formed, taken
from stiffmbs.solve.native.elimination.sides import add_full_sides, add_straight_sides, take_side_reactions
from stiffmbs.solve.native.tables.linear import BLOCK_ELIMINATION

PAIR, SINGLE, FORMING, NODE, UPDATE = 4, 3, 7, 10, 5
"""Numbers in a row of the lists."""

blocks_view = view_of("BlockElimination", BLOCK_ELIMINATION)


@compiled
def _clear(numbers, count):
    """Set the first `count` numbers, a multiple of four, to zero."""
    for k in range(0, count, 4):
        set_quad(numbers, k, spread(0.0))


@compiled
def _assemble(r, b, values):
    """Assemble S = j j^T by blocks with j = J M^-1/2, and x = j a - gamma with a = M^-1/2 f."""
    _clear(b.x, b.n_x)
    for k in range(b.n_gamma):
        b.x[b.gamma_place[k]] -= values[b.gamma_source[k]]
    for k in range(b.n_first):
        b.j[b.j_at[k]] = values[b.j_source[k]] * b.j_scale[k]
    for k in range(b.n_first, b.n_j):
        b.j[b.j_at[k]] += values[b.j_source[k]] * b.j_scale[k]
    _clear(b.blocks, b.n_panels)
    add_full_sides(r, b, values)
    add_straight_sides(r, b, values)
    for k in range(b.n_singles):
        p = shifted(b.single, SINGLE * k)
        b.x[p[0]] += b.j[p[1]] * r.a[p[2]]
    for k in range(b.n_pairs):
        p = shifted(b.pair, PAIR * k)
        width = p[3]
        j, a = shifted(b.j, p[1]), shifted(r.a, p[2])
        for at in range(0, width, 4):
            total = plus_product(quad(b.x, p[0] + at), spread(a[0]), quad(j, at))
            total = plus_product(total, spread(a[1]), quad(j, width + at))
            set_quad(b.x, p[0] + at, plus_product(total, spread(a[2]), quad(j, 2 * width + at)))
    for k in range(b.n_products):
        p = shifted(b.product, SINGLE * k)
        b.blocks[p[0]] += b.j[p[1]] * b.j[p[2]]
    for k in range(b.n_forming):
        p = shifted(b.forming, FORMING * k)
        formed(p[0], shifted(b.blocks, p[1]), p[2], shifted(b.j, p[3]), p[4], shifted(b.j, p[5]), p[6])


@compiled
def _factored_block(size, a, stride, pivot):
    """Factor a joint's block in place as L D L^T, with 1/D on the diagonal; store the pivots."""
    if size == 5:
        factor_symmetric(5, a, stride, pivot)
    elif size == 2:
        factor_symmetric(2, a, stride, pivot)
    elif size == 3:
        factor_symmetric(3, a, stride, pivot)
    elif size == 6:
        factor_symmetric(6, a, stride, pivot)
    else:
        for k in range(size):
            pivot[k] = a[k * stride + k]
            inverse = 1.0 / pivot[k]
            for i in range(k + 1, size):
                factor = a[i * stride + k] * inverse
                for j in range(k + 1, i + 1):
                    a[i * stride + j] -= factor * a[j * stride + k]
            for i in range(k + 1, size):
                a[i * stride + k] *= inverse
            a[k * stride + k] = inverse


@compiled
def _eliminated_rows(size, block, stride, rows, scaled, width):
    """Compute V = L^-1 U right of a joint's block, and D^-1 V, for one quad of columns."""
    if size == 5:
        eliminate_rows(5, block, stride, rows, scaled, width)
    elif size == 2:
        eliminate_rows(2, block, stride, rows, scaled, width)
    elif size == 3:
        eliminate_rows(3, block, stride, rows, scaled, width)
    elif size == 6:
        eliminate_rows(6, block, stride, rows, scaled, width)
    else:
        for k in range(size):
            line = quad(rows, k * stride)
            for i in range(k + 1, size):
                at = i * stride
                set_quad(rows, at, plus_product(quad(rows, at), spread(-block[at + k]), line))
            set_quad(scaled, k * width, plus_product(spread(0.0), spread(block[k * stride + k]), line))


@compiled
def _eliminated_vector(size, block, stride, x, scaled):
    """Compute x = L^-1 x of a joint, and D^-1 L^-1 x."""
    if size == 5:
        eliminate_vector(5, block, stride, x, scaled)
    elif size == 2:
        eliminate_vector(2, block, stride, x, scaled)
    elif size == 3:
        eliminate_vector(3, block, stride, x, scaled)
    elif size == 6:
        eliminate_vector(6, block, stride, x, scaled)
    else:
        for k in range(size):
            for i in range(k + 1, size):
                x[i] -= block[i * stride + k] * x[k]
            scaled[k] = block[k * stride + k] * x[k]


@compiled
def _completed_vector(size, block, stride, x):
    """Compute x = L^-T x of a joint."""
    if size == 5:
        complete_vector(5, block, stride, x)
    elif size == 2:
        complete_vector(2, block, stride, x)
    elif size == 3:
        complete_vector(3, block, stride, x)
    elif size == 6:
        complete_vector(6, block, stride, x)
    else:
        for k in range(size - 1, -1, -1):
            for i in range(k):
                x[i] -= block[k * stride + i] * x[k]


@compiled
def _forward(b, p, first):
    """Eliminate a joint from x, and update those listed from `first` on in `right`."""
    _eliminated_vector(p[0], shifted(b.blocks, p[2]), p[3], shifted(b.x, p[6]), shifted(b.y, p[6]))
    _carry(b, p, first)


@compiled
def _carry(b, p, first):
    """Update the joints listed from `first` on in `right` by an eliminated joint."""
    size, stride = p[0], p[3]
    block, y = shifted(b.blocks, p[2]), shifted(b.y, p[6])
    rows = shifted(block, p[1])
    for at in range(first, p[9]):
        into, column = shifted(b.x, b.right[at]), shifted(rows, 4 * (at - first))
        if size == 2:
            take_products(1, 1, into, 0, y, 1, column, stride, 2)
        elif size == 5:
            take_products(1, 1, into, 0, y, 1, column, stride, 5)
        else:
            take_products(1, 1, into, 0, y, 1, column, stride, size)


@compiled
def _backward(b):
    """Substitute x from the last joint to the first."""
    for k in range(b.n_nodes - 1, -1, -1):
        p = shifted(b.node, NODE * k)
        size, width = p[0], p[5]
        scaled, x, y = shifted(b.blocks, p[4]), shifted(b.x, p[6]), shifted(b.y, p[6])
        first = p[9] - width // 4
        for i in range(size):
            total = spread(0.0)
            for column in range(0, width, 4):
                total = plus_product(total, quad(scaled, i * width + column), quad(b.x, b.right[first + column // 4]))
            x[i] = y[i] - sum_of(total)
        _completed_vector(size, shifted(b.blocks, p[2]), p[3], x)


@compiled
def _factored(r, b):
    """Eliminate all blocks, and x with them; return True if all pivots are accurate."""
    r.kept = 1.0
    at = 0
    first_right = 0
    for k in range(b.n_nodes):
        p = shifted(b.node, NODE * k)
        size, stride, width, first = p[0], p[3], p[5], p[7]
        block = shifted(b.blocks, p[2])
        pivot, scaled, x, y = shifted(b.pivot, first), shifted(b.blocks, p[4]), shifted(b.x, p[6]), shifted(b.y, p[6])
        if size == 5 and width == 8:
            eliminate_node(5, 2, block, stride, pivot, scaled, x, y)
        elif size == 5 and width == 16:
            eliminate_node(5, 4, block, stride, pivot, scaled, x, y)
        else:
            _factored_block(size, block, stride, pivot)
            for column in range(0, width, 4):
                _eliminated_rows(size, block, stride, shifted(block, p[1] + column), shifted(scaled, column), width)
            _eliminated_vector(size, block, stride, x, y)
        for i in range(first, first + size):
            if not keeps_digits(r, b.pivot[i], b.diagonal[i]):
                return False
        while at < p[8]:
            u = shifted(b.update, UPDATE * at)
            into, factors, rows = shifted(b.blocks, u[1]), shifted(b.blocks, u[3]), shifted(b.blocks, u[4])
            if size == 5 and u[0] == 10:
                take_products(5, 2, into, u[2], factors, width, rows, stride, 5)
            elif size == 2 and u[0] == 3:
                take_products(2, 1, into, u[2], factors, width, rows, stride, 2)
            elif size == 3 and u[0] == 5:
                take_products(3, 1, into, u[2], factors, width, rows, stride, 3)
            elif size == 6 and u[0] == 12:
                take_products(6, 2, into, u[2], factors, width, rows, stride, 6)
            else:
                taken(u[0], into, u[2], factors, width, rows, stride, size)
            at += 1
        _carry(b, p, first_right)
        first_right = p[9]
    r.most_kept = max(r.most_kept, r.kept)
    return True


@compiled
def _take_reactions(r, b):
    """Compute a -= j^T x."""
    take_side_reactions(r, b)
    for k in range(b.n_singles):
        p = shifted(b.single, SINGLE * k)
        r.a[p[2]] -= b.j[p[1]] * b.x[p[0]]
    for k in range(b.n_pairs):
        p = shifted(b.pair, PAIR * k)
        width = p[3]
        j, x, a = shifted(b.j, p[1]), shifted(b.x, p[0]), shifted(r.a, p[2])
        for i in range(3):
            total = spread(0.0)
            for at in range(0, width, 4):
                total = plus_product(total, quad(j, i * width + at), quad(x, at))
            a[i] -= sum_of(total)


@compiled
def accelerate_by_blocks(r, b, s, values):
    """Compute M^1/2 u' in r.a from M^-1/2 f there, and multipliers in lam; return True if successful."""
    _assemble(r, b, values)
    for k in range(b.n_nodes):
        p = shifted(b.node, NODE * k)
        for i in range(p[0]):
            b.diagonal[p[7] + i] = b.blocks[p[2] + i * (p[3] + 1)]
    if not _factored(r, b):
        return False
    _backward(b)
    _take_reactions(r, b)
    for k in range(s.n_c):
        s.lam[k] = b.x[b.place[k]] if b.place[k] >= 0 else 0.0
    return True


@compiled
def move_by_blocks(r, b, s, violations):
    """Compute in r.a M^1/2 times the minimum-norm change of velocities that closes violations."""
    _clear(b.x, b.n_x)
    for k in range(s.n_c):
        if b.place[k] >= 0:
            b.x[b.place[k]] = violations[k]
    first = 0
    for k in range(b.n_nodes):
        p = shifted(b.node, NODE * k)
        _forward(b, p, first)
        first = p[9]
    _backward(b)
    _take_reactions(r, b)
