"""Derivatives of the forces of a beam section (`stiffmbs.compile.machine.beams.section`).

Matrices have a column for each velocity of the bodies: six, or three in the plane. Derivatives by quaternions follow from
those by rotations about the axes of a body.
"""

from stiffmbs.compile.machine.beams.dual import of_screws, of_wrenches
from stiffmbs.compile.machine.beams.nodes import node, node_view
from stiffmbs.compile.machine.beams.screws import second_slope, series, square, square_rate, tangent_slope
from stiffmbs.compile.machine.beams.section import (
    COLUMNS,
    NODES,
    component,
    damping,
    law,
    node_wrenches,
    radius,
    section_state,
    stiffness_times,
    strain,
    stretch,
)
from stiffmbs.compile.machine.native.access import compiled, room, shifted
from stiffmbs.compile.machine.native.vectors import clear, times, transposed_times

SIX_ROWS, TWELVE_ROWS, ALL_ROWS = 6 * COLUMNS, 12 * COLUMNS, COLUMNS * COLUMNS
"""Lengths of matrices with a column for each velocity."""


@compiled
def column(space, j):
    """Return the place of a body's velocity among those in space."""
    return j if space == 1 or j < 2 else 5


@compiled
def body_map(space, of_node, Y):
    """Compute the 6x6 matrix from a body's velocities in space to the twist of its node."""
    of = node_view(of_node)
    clear(36, Y)
    for i in range(3):
        for c in range(3):
            Y[6 * i + 3 + c] = of.C[3 * c + i]
            Y[6 * (3 + i) + c] = of.A[3 * c + i]
            j, l = (c + 1) % 3, (c + 2) % 3
            Y[6 * (3 + i) + 3 + c] = of.C[3 * j + i] * -of.point[l] + of.C[3 * l + i] * of.point[j]


@compiled
def add_product(space, width, slot, M, Y, to):
    """Add M Y to the columns of a body in a matrix of six rows."""
    per = 6 if space == 1 else 3
    for i in range(6):
        for c in range(per):
            x = 0.0
            for j in range(6):
                x += M[6 * i + j] * Y[6 * j + column(space, c)]
            to[width * i + per * slot + c] += x


@compiled
def add_to_rows(space, width, slot, Y, G, K):
    """Add Y^T G to the rows of a body."""
    per = 6 if space == 1 else 3
    for r in range(per):
        for j in range(6):
            y = Y[6 * j + column(space, r)]
            for c in range(width):
                K[width * (per * slot + r) + c] += y * G[width * j + c]


@compiled
def product_of(rows, inner, width, A, B, factor, C):
    """Add factor A B to C, with `inner` columns of A and `width` columns of B and C."""
    for i in range(rows):
        for j in range(inner):
            x = factor * A[inner * i + j]
            if x != 0.0:
                for c in range(width):
                    C[width * i + c] += x * B[width * j + c]


@compiled
def screw_slopes(space, n, width, reference, slots, nodes, maps, D):
    """Compute the derivatives (6, width) of each node's screw by the velocities' integrals."""
    m = int(slots[reference])
    for k in range(n):
        body_map(space, node(nodes, k), shifted(maps, 36 * k))
    clear(6 * n * width, D)
    for k in range(n):
        if k != reference:
            of = node_view(node(nodes, k))
            to = shifted(D, 6 * width * k)
            add_product(space, width, int(slots[k]), of.P, shifted(maps, 36 * k), to)
            add_product(space, width, m, of.Q, shifted(maps, 36 * reference), to)


@compiled
def second_derivatives(space, damped, n, law, curve, B, stress, W):
    """Compute the second derivatives (12, 12) of the strain energy by (xi, xi').

    With the stretch s = r^2/2 kappa_1^2 these are L (S^T K S + r^2 n_1 e_4 e_4^T), where S adds the slope of s to the
    first row of the derivatives B.
    """
    d = 6 if space == 1 else 3
    K = shifted(law, 2 * n + 1 + d)
    S, KS, x, y = room(72), room(72), room(6), room(6)
    clear(144, W)
    clear(72, KS)
    for i in range(d):
        for c in range(12):
            S[12 * i + c] = B[12 * component(space, i) + c]
    if space == 1:
        strain(space, n, law, curve, B, x)
        slope = stretch(space, damped, n, law, x)
        clear(6, y)
        stiffness_times(space, n, law, x, law[2 * n] * radius(damped, n, law), y)
        for r in range(12):
            S[r] += slope * S[36 + r]
            for c in range(12):
                W[12 * r + c] += y[0] * S[36 + r] * S[36 + c]
    for i in range(d):
        for j in range(d):
            for c in range(12):
                KS[12 * i + c] += law[2 * n] * K[d * i + j] * S[12 * j + c]
    for i in range(d):
        for r in range(12):
            of_row = S[12 * i + r]
            for c in range(12):
                W[12 * r + c] += of_row * KS[12 * i + c]
    w = room(6)
    clear(6, w)
    for i in range(d):
        w[(component(space, i) + 3) % 6] = law[2 * n] * stress[i]
    add_curvature(curve, w, W)


@compiled
def add_curvature(curve, w, W):
    """Add the second derivatives of w . T xi' by (xi, xi') for a wrench w = (n, m) to a matrix (12, 12)."""
    b, c, M, H = room(4), room(4), room(18), room(36)
    series(square(curve), 0, 3, b)
    series(square(curve), 1, 3, c)
    second_slope(curve, w, shifted(curve, 6), b, c, square_rate(curve), M)
    of_wrenches(M, 1.0, H)
    for i in range(6):
        for j in range(6):
            W[12 * i + j] += H[6 * i + j]
    tangent_slope(curve, w, b, -1.0, c, M)
    of_wrenches(M, 1.0, H)
    for i in range(6):
        for j in range(6):
            W[12 * (6 + i) + j] += H[6 * i + j]
            W[12 * j + 6 + i] += H[6 * i + j]


@compiled
def add_node_slopes(space, n, width, reference, slots, nodes, maps, D, own, K):
    """Add the derivatives of the nodes' wrenches for constant efforts on the screws."""
    M, S, G, g, half = room(18), room(36), room(SIX_ROWS), room(6), room(3)
    half[0], half[1], half[2] = 0.5, 0.0, 0.0
    for k in range(n):
        if k != reference:
            of = node_view(node(nodes, k))
            for i in range(3):
                g[i] = own[6 * k + 3 + i]
                g[3 + i] = own[6 * k + i]
            for part in range(2):
                sign = 1.0 - 2.0 * part
                tangent_slope(of.screw, g, half, sign, of.inverse, M)
                of_wrenches(M, sign, S)
                clear(6 * width, G)
                product_of(6, 6, width, S, shifted(D, 6 * width * k), 1.0, G)
                to = k if part == 0 else reference
                add_to_rows(space, width, int(slots[to]), shifted(maps, 36 * to), G, K)


@compiled
def add_turned_wrenches(space, n, width, slots, nodes, wrenches, K):
    """Add the derivatives of the forces in ground axes by rotations of the nodes that carry them."""
    x = room(3)
    per = 6 if space == 1 else 3
    for k in range(n):
        of = node_view(node(nodes, k))
        slot = int(slots[k])
        times(of.C, shifted(wrenches, 6 * k + 3), x)
        for c in range(3 if space == 1 else 1):
            about = c if space == 1 else 2
            j, l = (about + 1) % 3, (about + 2) % 3
            for i in range(3 if space == 1 else 2):
                # R (e_about x x)
                y = of.R[3 * i + l] * x[j] - of.R[3 * i + j] * x[l]
                K[width * (per * slot + i) + per * slot + (3 + c if space == 1 else 2)] += y


@compiled
def rate_slopes(space, n, width, reference, slots, law, nodes, maps, D, X, curve, B, rates, V):
    """Compute the derivatives (6, width) of the strain's rate by the pose at constant velocities."""
    d = 6 if space == 1 else 3
    M, S, unit, half = room(18), room(36), room(6), room(3)
    W, T, Z, G = room(144), room(12), room(TWELVE_ROWS), room(SIX_ROWS)
    clear(6 * width, V)
    for i in range(d):
        clear(6, unit)
        clear(144, W)
        clear(12, T)
        unit[(component(space, i) + 3) % 6] = 1.0
        add_curvature(curve, unit, W)
        for a in range(12):
            for c in range(12):
                T[c] += rates[a] * W[12 * a + c]
        product_of(1, 12, width, T, X, 1.0, shifted(V, width * i))
    clear(12 * width, Z)
    half[0], half[1], half[2] = -0.5, 0.0, 0.0
    for k in range(n):
        if k != reference:
            of = node_view(node(nodes, k))
            clear(6 * width, G)
            for part in range(2):
                sign = 1.0 - 2.0 * part
                of_part = k if part == 0 else reference
                twist = node_view(node(nodes, of_part)).twist
                tangent_slope(of.screw, twist, half, sign, of.inverse, M)
                of_screws(M, S)
                product_of(6, 6, width, S, shifted(D, 6 * width * k), sign, G)
                add_turned(space, width, slots, of_part, nodes, shifted(of.P, 36 * part), G)
            for i in range(6):
                for c in range(width):
                    Z[width * i + c] += law[k] * G[width * i + c]
                    Z[width * (6 + i) + c] += law[n + k] * G[width * i + c]
    for i in range(d):
        product_of(1, 12, width, shifted(B, 12 * component(space, i)), Z, 1.0, shifted(V, width * i))


@compiled
def add_turned(space, width, slots, k, nodes, P, G):
    """Add P times the derivatives of a node's twist by the rotation of its body at constant velocities."""
    of = node_view(node(nodes, k))
    per = 6 if space == 1 else 3
    x, y = room(3), room(3)
    for c in range(3 if space == 1 else 1):
        about = c if space == 1 else 2
        j, l = (about + 1) % 3, (about + 2) % 3
        # carried x e_about, in the axes of the body
        x[about], x[j], x[l] = 0.0, of.carried[l], -of.carried[j]
        transposed_times(of.C, x, y)
        for i in range(6):
            at = width * i + per * int(slots[k]) + (3 + c if space == 1 else 2)
            G[at] += P[6 * i + 3] * y[0] + P[6 * i + 4] * y[1] + P[6 * i + 5] * y[2]


@compiled
def add_force_slopes(space, damped, n, n_slots, slots, numbers, index, q, turn, u, f_q, f_u):
    """Compute the derivatives of the forces by coordinates and, with damping, by velocities."""
    per = 6 if space == 1 else 3
    width = per * n_slots
    nodes, curve, B, rates, stress = room(NODES), room(12), room(72), room(12), room(6)
    wrenches, own, maps, D = room(COLUMNS), room(COLUMNS), room(SIX_ROWS), room(ALL_ROWS)
    X, W, WX, K = room(TWELVE_ROWS), room(144), room(TWELVE_ROWS), room(ALL_ROWS)
    reference = section_state(space, damped, 2, n, slots, numbers, index, q, turn, u, nodes, curve, B, rates, stress)
    of_section = law(space, n, numbers)
    node_wrenches(space, n, reference, of_section, nodes, B, stress, wrenches, own)
    screw_slopes(space, n, width, reference, slots, nodes, maps, D)
    clear(12 * width, X)
    for k in range(n):
        if k != reference:
            product_of(1, 1, 6 * width, shifted(of_section, k), shifted(D, 6 * width * k), 1.0, X)
            to = shifted(X, 6 * width)
            product_of(1, 1, 6 * width, shifted(of_section, n + k), shifted(D, 6 * width * k), 1.0, to)
    second_derivatives(space, damped, n, of_section, curve, B, stress, W)
    clear(12 * width, WX)
    product_of(12, 12, width, W, X, 1.0, WX)
    clear(width * width, K)
    transposed_product(12, width, X, WX, 1.0, K)
    add_node_slopes(space, n, width, reference, slots, nodes, maps, D, own, K)
    add_turned_wrenches(space, n, width, slots, nodes, wrenches, K)
    if damped == 1:
        viscous_slopes(space, n, width, reference, slots, of_section, nodes, maps, D, X, curve, B, rates, K, f_u)
    if space == 1:
        by_quaternions(n_slots, index, turn, K, f_q)
    else:
        for i in range(width * width):
            f_q[i] = -K[i]


@compiled
def transposed_product(rows, width, A, B, factor, C):
    """Add factor A^T B to C for matrices with the same shape (rows, width)."""
    for r in range(width):
        for j in range(rows):
            x = factor * A[width * j + r]
            if x != 0.0:
                for c in range(width):
                    C[width * r + c] += x * B[width * j + c]


@compiled
def viscous_slopes(space, n, width, reference, slots, law, nodes, maps, D, X, curve, B, rates, K, f_u):
    """Compute the derivatives of the viscous forces by velocities, and add those by the pose."""
    d = 6 if space == 1 else 3
    strains, stresses, V = room(SIX_ROWS), room(SIX_ROWS), room(SIX_ROWS)
    clear(6 * width, strains)
    clear(6 * width, stresses)
    for i in range(d):
        product_of(1, 12, width, shifted(B, 12 * component(space, i)), X, 1.0, shifted(strains, width * i))
    factor = damping(space, n, law) * law[2 * n]
    product_of(d, d, width, shifted(law, 2 * n + 1 + d), strains, factor, stresses)
    clear(width * width, f_u)
    transposed_product(d, width, strains, stresses, -1.0, f_u)
    rate_slopes(space, n, width, reference, slots, law, nodes, maps, D, X, curve, B, rates, V)
    transposed_product(d, width, stresses, V, 1.0, K)


@compiled
def by_quaternions(n_slots, index, turn, K, f_q):
    """Compute -K with the columns of rotations replaced by those of the quaternions."""
    width = 6 * n_slots
    for body in range(n_slots):
        e = shifted(turn, 2 * index[2 * body] + 9)
        for row in range(width):
            of, to = shifted(K, width * row + 6 * body), shifted(f_q, 7 * n_slots * row + 7 * body)
            x, y, z = -of[3], -of[4], -of[5]
            for i in range(3):
                to[i] = -of[i]
            to[3] = -x * e[1] - y * e[2] - z * e[3]
            to[4] = x * e[0] - y * e[3] + z * e[2]
            to[5] = x * e[3] + y * e[0] - z * e[1]
            to[6] = -x * e[2] + y * e[1] + z * e[0]
