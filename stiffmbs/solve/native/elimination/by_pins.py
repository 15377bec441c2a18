"""J M^-1 J^T of planar pins: blocks of two equations, whose entries stand where a point of one body meets that of another.

A pin's rows of J are (p, 0, a) and (0, r, b) for the velocities of each of its two bodies.  The effort grows as the number of pins in
trees, as that of the articulated-body algorithm does (Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 7).
"""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import compiled, shifted, view_of
from stiffmbs.solve.native.elimination.digits import SMALL, keeps_digits
from stiffmbs.solve.native.tables.linear import PIN_ELIMINATION

PIN, PRODUCT = 9, 2
"""Numbers in a row of the lists."""

pins_view = view_of("PinElimination", PIN_ELIMINATION)


@compiled
def _assemble(r, e, values):
    """W = J M^-1, blocks of J W^T, and x = W f - gamma with the forces f in r.a."""
    for k in range(e.n):
        pin, m, w = shifted(e.pin, PIN * k), shifted(e.inverse, 6 * k), shifted(e.w, 8 * k)
        first, second = shifted(values, pin[0]), shifted(values, pin[1])
        p_i, a_i, r_i, b_i = first[0], first[1], second[0], second[1]
        first, second = shifted(values, pin[2]), shifted(values, pin[3])
        p_j, a_j, r_j, b_j = first[0], first[1], second[0], second[1]
        x, y = -values[pin[4]], -values[pin[5]]
        wp_i, wr_i, wa_i, wb_i = p_i * m[0], r_i * m[1], a_i * m[2], b_i * m[2]
        wp_j, wr_j, wa_j, wb_j = p_j * m[3], r_j * m[4], a_j * m[5], b_j * m[5]
        i, j = shifted(r.a, pin[6]), shifted(r.a, pin[7])
        x += wp_i * i[0] + wa_i * i[2] + (wp_j * j[0] + wa_j * j[2])
        y += wr_i * i[1] + wb_i * i[2] + (wr_j * j[1] + wb_j * j[2])
        xx = p_i * wp_i + a_i * wa_i + (p_j * wp_j + a_j * wa_j)
        xy = a_i * wb_i + a_j * wb_j
        yy = r_i * wr_i + b_i * wb_i + (r_j * wr_j + b_j * wb_j)
        w[0], w[1], w[2], w[3] = wp_i, wr_i, wa_i, wb_i
        w[4], w[5], w[6], w[7] = wp_j, wr_j, wa_j, wb_j
        own, diagonal, rhs = shifted(e.block, 4 * k), shifted(e.diagonal, 2 * k), shifted(e.x, 2 * k)
        own[0], own[1], own[2] = xx, xy, yy
        diagonal[0], diagonal[1] = xx, yy
        rhs[0], rhs[1] = x, y
    for k in range(e.n_beside):
        product, m = shifted(e.product, PRODUCT * k), shifted(e.mass, 3 * k)
        v, w, beside = shifted(e.w, product[0]), shifted(e.w, product[1]), shifted(e.beside, 4 * k)
        p, s, a, b = v[0] * m[0], v[1] * m[1], v[2] * m[2], v[3] * m[2]
        wp, wr, wa, wb = w[0], w[1], w[2], w[3]
        beside[0], beside[1] = p * wp + a * wa, a * wb
        beside[2], beside[3] = b * wa, s * wr + b * wb


@compiled
def _factored(r, e):
    """Blocks eliminated one after the other, and x with them; whether all pivots kept enough digits.

    Blocks on the diagonal receive their inverses, and `scaled` those beside them multiplied by these.
    """
    r.kept = 1.0
    at = 0
    for k in range(e.n):
        own, diagonal, x = shifted(e.block, 4 * k), shifted(e.diagonal, 2 * k), shifted(e.x, 2 * k)
        xx, xy, yy = own[0], own[1], own[2]
        determinant = xx * yy - xy * xy
        kept = xx > SMALL * diagonal[0] and determinant > SMALL * xx * diagonal[1]
        if not kept and not keeps_digits(r, xx, diagonal[0]):
            return False
        if not kept and not keeps_digits(r, determinant / xx, diagonal[1]):
            return False
        inverse = 1.0 / determinant
        xx, xy, yy = yy * inverse, -xy * inverse, xx * inverse
        x0, x1 = xx * x[0] + xy * x[1], xy * x[0] + yy * x[1]
        own[0], own[1], own[2] = xx, xy, yy
        x[0], x[1] = x0, x1
        end = e.start[k + 1]
        for m in range(e.start[k], end):
            o, v = shifted(e.beside, 4 * m), shifted(e.scaled, 4 * m)
            o00, o01, o10, o11 = o[0], o[1], o[2], o[3]
            v00, v01, v10, v11 = xx * o00 + xy * o10, xx * o01 + xy * o11, xy * o00 + yy * o10, xy * o01 + yy * o11
            v[0], v[1], v[2], v[3] = v00, v01, v10, v11
            later = e.later[m]
            into, rhs = shifted(e.block, 4 * later), shifted(e.x, 2 * later)
            d0, d1, d2 = o00 * v00 + o10 * v10, o00 * v01 + o10 * v11, o01 * v01 + o11 * v11
            into[0] -= d0
            into[1] -= d1
            into[2] -= d2
            rhs[0] -= o00 * x0 + o10 * x1
            rhs[1] -= o01 * x0 + o11 * x1
            for n in range(m + 1, end):
                o, into = shifted(e.beside, 4 * n), shifted(e.beside, 4 * e.update[at])
                into[0] -= v00 * o[0] + v10 * o[2]
                into[1] -= v00 * o[1] + v10 * o[3]
                into[2] -= v01 * o[0] + v11 * o[2]
                into[3] -= v01 * o[1] + v11 * o[3]
                at += 1
    r.most_kept = max(r.most_kept, r.kept)
    return True


@compiled
def _forward(e):
    """x overwritten by D^-1 L^-1 x."""
    for k in range(e.n):
        own, x = shifted(e.block, 4 * k), shifted(e.x, 2 * k)
        x0, x1 = x[0], x[1]
        x[0], x[1] = own[0] * x0 + own[1] * x1, own[1] * x0 + own[2] * x1
        for m in range(e.start[k], e.start[k + 1]):
            v, rhs = shifted(e.scaled, 4 * m), shifted(e.x, 2 * e.later[m])
            rhs[0] -= v[0] * x0 + v[2] * x1
            rhs[1] -= v[1] * x0 + v[3] * x1


@compiled
def _backward(r, e):
    """x overwritten by L^-T x, and W^T x taken out of r.a."""
    for k in range(e.n - 1, -1, -1):
        x = shifted(e.x, 2 * k)
        x0, x1 = x[0], x[1]
        for m in range(e.start[k], e.start[k + 1]):
            v, after = shifted(e.scaled, 4 * m), shifted(e.x, 2 * e.later[m])
            x0 -= v[0] * after[0] + v[1] * after[1]
            x1 -= v[2] * after[0] + v[3] * after[1]
        x[0], x[1] = x0, x1
        pin, w = shifted(e.pin, PIN * k), shifted(e.w, 8 * k)
        i, j = shifted(r.a, pin[6]), shifted(r.a, pin[7])
        i[0] -= w[0] * x0
        i[1] -= w[1] * x1
        i[2] -= w[2] * x0 + w[3] * x1
        j[0] -= w[4] * x0
        j[1] -= w[5] * x1
        j[2] -= w[6] * x0 + w[7] * x1


@compiled
def accelerate_by_pins(r, e, s, values):
    """From f in r.a, u' there and multipliers in lam; whether that could be done."""
    _assemble(r, e, values)
    if not _factored(r, e):
        return False
    for k in range(r.n_u):
        r.a[k] *= r.scale[k] * r.scale[k]
    _backward(r, e)
    for k in range(e.n):
        row = e.pin[PIN * k + 8]
        s.lam[row], s.lam[row + 1] = e.x[2 * k], e.x[2 * k + 1]
    return True


@compiled
def move_by_pins(r, e, violations):
    """In r.a the smallest change of velocities that closes violations."""
    for k in range(e.n):
        row = e.pin[PIN * k + 8]
        e.x[2 * k], e.x[2 * k + 1] = violations[row], violations[row + 1]
    _forward(e)
    _backward(r, e)
