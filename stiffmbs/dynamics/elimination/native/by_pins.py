"""J M^-1 J^T of planar revolute joints, by blocks of two equations.

The rows of a joint in J are (p, 0, a) and (0, r, b) for the velocities of each of its two bodies.  For trees, the cost
is linear in the number of joints, as for the articulated-body algorithm (Featherstone, Rigid Body Dynamics
Algorithms, 2008, ch. 7).
"""

from stiffmbs.compile.machine.native.access import compiled, row_of, shifted, view_of
from stiffmbs.compile.machine.native.simd import plus_product
from stiffmbs.dynamics.elimination.native.digits import keeps_digits
from stiffmbs.dynamics.elimination.native.layouts import PIN_ELIMINATION, Pin, PinProduct
from stiffmbs.dynamics.native.parameters import ELIMINATION

pins_view = view_of("PinElimination", PIN_ELIMINATION)
pin_of = row_of(Pin)
product_of = row_of(PinProduct)


@compiled
def _assemble(r, e, values):
    """Assemble W = J M^-1, the blocks of J W^T, and x = W f - gamma with the forces f in r.a."""
    for k in range(e.n):
        pin = pin_of(e.pin, k)
        m, w = shifted(e.inverse, 6 * k), shifted(e.w, 8 * k)
        first, second = shifted(values, pin.x_i), shifted(values, pin.y_i)
        p_i, a_i, r_i, b_i = first[0], first[1], second[0], second[1]
        first, second = shifted(values, pin.x_j), shifted(values, pin.y_j)
        p_j, a_j, r_j, b_j = first[0], first[1], second[0], second[1]
        i, j = shifted(r.a, pin.velocity_i), shifted(r.a, pin.velocity_j)
        wp_i, wr_i, wa_i, wb_i = p_i * m[0], r_i * m[1], a_i * m[2], b_i * m[2]
        wp_j, wr_j, wa_j, wb_j = p_j * m[3], r_j * m[4], a_j * m[5], b_j * m[5]
        x = plus_product(plus_product(-values[pin.gamma_x], wp_i, i[0]), wa_i, i[2])
        x = plus_product(plus_product(x, wp_j, j[0]), wa_j, j[2])
        y = plus_product(plus_product(-values[pin.gamma_y], wr_i, i[1]), wb_i, i[2])
        y = plus_product(plus_product(y, wr_j, j[1]), wb_j, j[2])
        xx = plus_product(plus_product(p_i * wp_i, a_i, wa_i) + p_j * wp_j, a_j, wa_j)
        xy = plus_product(a_i * wb_i, a_j, wb_j)
        yy = plus_product(plus_product(r_i * wr_i, b_i, wb_i) + r_j * wr_j, b_j, wb_j)
        w[0], w[1], w[2], w[3] = wp_i, wr_i, wa_i, wb_i
        w[4], w[5], w[6], w[7] = wp_j, wr_j, wa_j, wb_j
        own, diagonal, rhs = shifted(e.block, 4 * k), shifted(e.diagonal, 2 * k), shifted(e.x, 2 * k)
        own[0], own[1], own[2] = xx, xy, yy
        diagonal[0], diagonal[1] = xx, yy
        rhs[0], rhs[1] = x, y
    for k in range(e.n_adjacent):
        product, m = product_of(e.product, k), shifted(e.mass, 3 * k)
        v, w, adjacent = shifted(e.w, product.first), shifted(e.w, product.second), shifted(e.adjacent, 4 * k)
        p, s, a, b = v[0] * m[0], v[1] * m[1], v[2] * m[2], v[3] * m[2]
        wa, wb = w[2], w[3]
        xx, yy = plus_product(p * w[0], a, wa), plus_product(s * w[1], b, wb)
        adjacent[0], adjacent[1], adjacent[2], adjacent[3] = xx, a * wb, b * wa, yy


@compiled
def _factored(r, e):
    """Eliminate all blocks, and x with them to D^-1 L^-1 x; return True if all pivots are accurate.

    Each diagonal block is overwritten by its 1/D and L; `scaled` receives -D^-1 L^-1 times the blocks right of it.
    Inverses of blocks would be less expensive, but lose digits for very light bodies.
    """
    r.kept = 1.0
    at = 0
    for k in range(e.n):
        own, diagonal, x = shifted(e.block, 4 * k), shifted(e.diagonal, 2 * k), shifted(e.x, 2 * k)
        xx, xy, yy = own[0], own[1], own[2]
        determinant = plus_product(xx * yy, -xy, xy)
        kept = xx > ELIMINATION.small * diagonal[0] and determinant > ELIMINATION.small * xx * diagonal[1]
        if not kept and not keeps_digits(r, xx, diagonal[0]):
            return False
        if not kept and not keeps_digits(r, determinant / xx, diagonal[1]):
            return False
        first = 1.0 / xx
        second = xx * (1.0 / determinant)  # in parallel with the other division
        lower = xy * first
        x0, x1 = x[0], plus_product(x[1], -lower, x[0])
        own[0], own[1], own[2] = first, lower, second
        x[0], x[1] = x0 * first, x1 * second
        end = e.start[k + 1]
        for m in range(e.start[k], end):
            o, scaled, later = shifted(e.adjacent, 4 * m), shifted(e.scaled, 4 * m), e.later[m]
            into, rhs = shifted(e.block, 4 * later), shifted(e.x, 2 * later)
            o00, o01 = o[0], o[1]
            o10, o11 = plus_product(o[2], -lower, o00), plus_product(o[3], -lower, o01)
            s00, s01, s10, s11 = -(o00 * first), -(o01 * first), -(o10 * second), -(o11 * second)
            d0 = plus_product(plus_product(into[0], s00, o00), s10, o10)
            d1 = plus_product(plus_product(into[1], s00, o01), s10, o11)
            d2 = plus_product(plus_product(into[2], s01, o01), s11, o11)
            b0 = plus_product(plus_product(rhs[0], s00, x0), s10, x1)
            b1 = plus_product(plus_product(rhs[1], s01, x0), s11, x1)
            scaled[0], scaled[1], scaled[2], scaled[3] = s00, s01, s10, s11
            into[0], into[1], into[2] = d0, d1, d2
            rhs[0], rhs[1] = b0, b1
            for n in range(m + 1, end):
                o, into = shifted(e.adjacent, 4 * n), shifted(e.adjacent, 4 * e.update[at])
                o10, o11 = o[2] - lower * o[0], o[3] - lower * o[1]
                into[0] += s00 * o[0] + s10 * o10
                into[1] += s00 * o[1] + s10 * o11
                into[2] += s01 * o[0] + s11 * o10
                into[3] += s01 * o[1] + s11 * o11
                at += 1
    r.most_kept = max(r.most_kept, r.kept)
    return True


@compiled
def _forward(e):
    """Overwrite x by D^-1 L^-1 x."""
    for k in range(e.n):
        own, x = shifted(e.block, 4 * k), shifted(e.x, 2 * k)
        x0, x1 = x[0], x[1] - own[1] * x[0]
        x[0], x[1] = x0 * own[0], x1 * own[2]
        for m in range(e.start[k], e.start[k + 1]):
            scaled, rhs = shifted(e.scaled, 4 * m), shifted(e.x, 2 * e.later[m])
            rhs[0] += scaled[0] * x0 + scaled[2] * x1
            rhs[1] += scaled[1] * x0 + scaled[3] * x1


@compiled
def _backward(r, e):
    """Overwrite x by L^-T x, and subtract W^T x from r.a."""
    for k in range(e.n - 1, -1, -1):
        pin = pin_of(e.pin, k)
        x, w = shifted(e.x, 2 * k), shifted(e.w, 8 * k)
        x0, x1 = x[0], x[1]
        for m in range(e.start[k], e.start[k + 1]):
            scaled, after = shifted(e.scaled, 4 * m), shifted(e.x, 2 * e.later[m])
            y0, y1 = after[0], after[1]
            x0 = plus_product(plus_product(x0, scaled[0], y0), scaled[1], y1)
            x1 = plus_product(plus_product(x1, scaled[2], y0), scaled[3], y1)
        x0 = plus_product(x0, -e.block[4 * k + 1], x1)
        x[0], x[1] = x0, x1
        i, j = shifted(r.a, pin.velocity_i), shifted(r.a, pin.velocity_j)
        i0, i1 = plus_product(i[0], -w[0], x0), plus_product(i[1], -w[1], x1)
        j0, j1 = plus_product(j[0], -w[4], x0), plus_product(j[1], -w[5], x1)
        i2 = plus_product(plus_product(i[2], -w[2], x0), -w[3], x1)
        j2 = plus_product(plus_product(j[2], -w[6], x0), -w[7], x1)
        i[0], i[1], i[2] = i0, i1, i2
        j[0], j[1], j[2] = j0, j1, j2


@compiled
def _clear_ground(r):
    """Clear the force on the ground, which follows all bodies."""
    for k in range(r.n_u, r.n_u + 3):
        r.a[k] = 0.0


@compiled
def accelerate_by_pins(r, e, s, values):
    """Compute u' in r.a from f there, and multipliers in lam; return True if successful."""
    _clear_ground(r)
    _assemble(r, e, values)
    if not _factored(r, e):
        return False
    for k in range(r.n_u):
        r.a[k] *= r.scale[k] * r.scale[k]
    _backward(r, e)
    for k in range(e.n):
        row = pin_of(e.pin, k).row
        s.lam[row], s.lam[row + 1] = e.x[2 * k], e.x[2 * k + 1]
    return True


@compiled
def move_by_pins(r, e, violations):
    """Compute in r.a the minimum-norm change of velocities that closes violations."""
    _clear_ground(r)
    for k in range(e.n):
        row = pin_of(e.pin, k).row
        e.x[2 * k], e.x[2 * k + 1] = violations[row], violations[row + 1]
    _forward(e)
    _backward(r, e)
