"""Forces and energies of a cross section of a beam whose strain is interpolated between nodes.

The screws of the nodes from the reference are interpolated by polynomials, xi(s) = sum a_k xi_k, and the strain is
T(xi) xi'. The numbers are the markers of the nodes, the reference, a_k, a_k', and the section's length. They end with the strain
without load, the stiffness by rows, the ratio of viscous to elastic stiffness, and in space the stretch r^2 by torsion. Strains are in the order of the
section's forces: three translations and rotations, in the plane two and one.
"""

from stiffmbs.compile.machine.beams.dual import of_screws
from stiffmbs.compile.machine.beams.nodes import (
    node,
    node_view,
    place_in_plane,
    place_in_space,
    relative_screw,
    relative_tangents,
)
from stiffmbs.compile.machine.beams.screws import series, square, tangent, tangent_slope
from stiffmbs.compile.machine.native.access import compiled, room, shifted
from stiffmbs.compile.machine.native.vectors import clear, cross, times
from stiffmbs.elements.forces.beam_layout import OF_NODE, SCREW

MOST = 5
"""Largest number of nodes."""
NODES = MOST * OF_NODE
"""Length of the values of all nodes."""
COLUMNS = 6 * MOST
"""Largest number of velocities."""


@compiled
def place_nodes(space, orders, n, slots, numbers, index, q, turn, u, nodes):
    """Compute the poses and twists of the nodes, and their screws from the reference, and return the reference."""
    width, stride = 5, 1
    if space == 1:
        width, stride = 16, 2
    reference = int(numbers[width * n])
    for k in range(n):
        first, of_u = int(index[2 * int(slots[k])]), int(index[2 * int(slots[k]) + 1])
        placed = shifted(numbers, width * k)
        if space == 1:
            place_in_space(placed, shifted(q, first), shifted(turn, stride * first), shifted(u, of_u), node(nodes, k))
        else:
            place_in_plane(placed, shifted(q, first), shifted(turn, first), shifted(u, of_u), node(nodes, k))
    for k in range(n):
        if k != reference:
            relative_screw(space, orders, node(nodes, reference), node(nodes, k))
    return reference


@compiled
def law(space, n, numbers):
    """Return the numbers after those of the markers and the reference."""
    return shifted(numbers, n * (16 if space == 1 else 5) + 1)


@compiled
def component(space, i):
    """Return the place of a component of the section's strain in a screw (theta, u)."""
    if space == 1:
        return (i + 3) % 6
    return 2 if i == 2 else 3 + i


@compiled
def interpolate(n, reference, values, of_nodes, step, to):
    """Compute the screw and its slope, (xi, xi'), or their rates, from six values of each node, `step` numbers apart."""
    clear(12, to)
    for k in range(n):
        if k != reference:
            for i in range(6):
                to[i] += values[k] * of_nodes[step * k + i]
                to[6 + i] += values[n + k] * of_nodes[step * k + i]


@compiled
def strain_slopes(curve, B):
    """Compute the derivatives (6, 12) of the strain T(xi) xi' by xi and xi'."""
    b, c, M, E = room(4), room(4), room(18), room(36)
    series(square(curve), 0, 2, b)
    series(square(curve), 1, 2, c)
    for part in range(2):
        if part == 0:
            tangent_slope(curve, shifted(curve, 6), b, 1.0, c, M)
        else:
            tangent(curve, b, 1.0, c, M)
        of_screws(M, E)
        for i in range(6):
            for j in range(6):
                B[12 * i + 6 * part + j] = E[6 * i + j]


@compiled
def strain(space, n, law, curve, B, to):
    """Compute the strain less that without load."""
    d = 6 if space == 1 else 3
    for i in range(d):
        row = component(space, i)
        to[i] = -law[2 * n + 1 + i]
        for j in range(6):
            to[i] += B[12 * row + 6 + j] * curve[6 + j]


@compiled
def stretch(space, damped, n, law, x):
    """Add the mean stretch r^2/2 kappa_1^2 of the fibres by torsion (Wagner) to a strain, and return its slope r^2 kappa_1."""
    slope = 0.0
    if space == 1:
        slope = radius(damped, n, law) * x[3]
        x[0] += 0.5 * slope * x[3]
    return slope


@compiled
def radius(damped, n, law):
    """Return r^2 of the stretch by torsion of a section in space."""
    return law[2 * n + 43 + damped]


@compiled
def strain_rate(space, B, rates, to):
    """Compute the rate of the strain from (xi', xi'')."""
    d = 6 if space == 1 else 3
    for i in range(d):
        row = component(space, i)
        to[i] = 0.0
        for j in range(12):
            to[i] += B[12 * row + j] * rates[j]


@compiled
def stiffness_times(space, n, law, x, factor, to):
    """Add factor K x."""
    d = 6 if space == 1 else 3
    K = shifted(law, 2 * n + 1 + d)
    for i in range(d):
        for j in range(d):
            to[i] += factor * K[d * i + j] * x[j]


@compiled
def damping(space, n, law):
    """Return the ratio of viscous to elastic stiffness."""
    return law[2 * n + (43 if space == 1 else 13)]


@compiled
def screw_rates(n, reference, nodes, rates):
    """Compute xi_k' of each node from the twists: P y_k + Q y_m, six numbers each."""
    m = node_view(node(nodes, reference))
    for k in range(n):
        of = node_view(node(nodes, k))
        for i in range(6):
            rates[6 * k + i] = 0.0
            if k != reference:
                for j in range(6):
                    rates[6 * k + i] += of.P[6 * i + j] * of.twist[j] + of.Q[6 * i + j] * m.twist[j]


@compiled
def section_state(space, damped, orders, n, slots, numbers, index, q, turn, u, nodes, curve, B, rates, stress):
    """Compute the nodes, (xi, xi'), the strain's derivatives and rate, and the stress; return the reference node."""
    reference = place_nodes(space, orders, n, slots, numbers, index, q, turn, u, nodes)
    of_section = law(space, n, numbers)
    found, of_nodes = room(6), room(COLUMNS)
    interpolate(n, reference, of_section, shifted(nodes, SCREW), OF_NODE, curve)
    strain_slopes(curve, B)
    strain(space, n, of_section, curve, B, found)
    slope = stretch(space, damped, n, of_section, found)
    clear(6, stress)
    clear(12, rates)
    stiffness_times(space, n, of_section, found, 1.0, stress)
    stress[3] += slope * stress[0]
    for k in range(n):
        if k != reference:
            relative_tangents(node(nodes, k))
    if damped == 1:
        screw_rates(n, reference, nodes, of_nodes)
        interpolate(n, reference, of_section, of_nodes, 6, rates)
        strain_rate(space, B, rates, found)
        stiffness_times(space, n, of_section, found, damping(space, n, of_section), stress)
    return reference


@compiled
def transposed_times(M, factor, x, y):
    """Add factor M^T x to y for a 6x6 matrix."""
    for i in range(6):
        for j in range(6):
            y[i] += factor * M[6 * j + i] * x[j]


@compiled
def node_wrenches(space, n, reference, law, nodes, B, stress, wrenches, own):
    """Compute the wrench (m, n) on each node along its axes, and the efforts on the screws, six numbers each."""
    effort = room(12)
    clear(12, effort)
    clear(6 * n, wrenches)
    for i in range(6 if space == 1 else 3):
        row = component(space, i)
        for j in range(12):
            effort[j] += law[2 * n] * B[12 * row + j] * stress[i]
    for k in range(n):
        if k != reference:
            of = node_view(node(nodes, k))
            g = shifted(own, 6 * k)
            for i in range(6):
                g[i] = law[k] * effort[i] + law[n + k] * effort[6 + i]
            transposed_times(of.P, 1.0, g, shifted(wrenches, 6 * k))
            transposed_times(of.Q, 1.0, g, shifted(wrenches, 6 * reference))


@compiled
def add_forces(space, damped, n, slots, numbers, index, q, turn, u, f):
    """Compute the forces on the bodies: the nodes' wrenches with the opposite sign."""
    nodes, curve, B, rates, stress = room(NODES), room(12), room(72), room(12), room(6)
    wrenches, own, x, y, z = room(COLUMNS), room(COLUMNS), room(3), room(3), room(3)
    reference = section_state(space, damped, 1, n, slots, numbers, index, q, turn, u, nodes, curve, B, rates, stress)
    for k in range(n):
        clear(6 if space == 1 else 3, shifted(f, (6 if space == 1 else 3) * int(slots[k])))
    node_wrenches(space, n, reference, law(space, n, numbers), nodes, B, stress, wrenches, own)
    for k in range(n):
        of = node_view(node(nodes, k))
        wrench = shifted(wrenches, 6 * k)
        to = shifted(f, (6 if space == 1 else 3) * int(slots[k]))
        times(of.C, shifted(wrench, 3), x)
        times(of.C, wrench, y)
        cross(of.point, x, z)
        for i in range(3):
            y[i] += z[i]
        times(of.R, x, z)
        if space == 1:
            for i in range(3):
                to[i] -= z[i]
                to[3 + i] -= y[i]
        else:
            to[0] -= z[0]
            to[1] -= z[1]
            to[2] -= y[2]


@compiled
def add_stress(space, damped, n, slots, numbers, index, q, turn, u, to):
    """Compute the section's forces and moments."""
    nodes, curve, B, rates, stress = room(NODES), room(12), room(72), room(12), room(6)
    section_state(space, damped, 1, n, slots, numbers, index, q, turn, u, nodes, curve, B, rates, stress)
    for i in range(6 if space == 1 else 3):
        to[i] = stress[i]


@compiled
def energy(space, damped, n, slots, numbers, index, q, turn, u, dissipated, to):
    """Compute the strain energy, or the power of the viscous stress, which is negative."""
    nodes, curve, B, rates, stress, x, y = room(NODES), room(12), room(72), room(12), room(6), room(6), room(6)
    section_state(space, damped, 1, n, slots, numbers, index, q, turn, u, nodes, curve, B, rates, stress)
    of_section = law(space, n, numbers)
    factor = 0.5
    if dissipated == 1:
        strain_rate(space, B, rates, x)
        factor = -damping(space, n, of_section)
    else:
        strain(space, n, of_section, curve, B, x)
        stretch(space, damped, n, of_section, x)
    clear(6, y)
    stiffness_times(space, n, of_section, x, factor * of_section[2 * n], y)
    to[0] = 0.0
    for i in range(6 if space == 1 else 3):
        to[0] += x[i] * y[i]


@compiled
def add_margins(space, n, slots, numbers, index, q, turn, u, to):
    """Compute the margin of each node but the reference to a rotation of 270 degrees."""
    nodes = room(NODES)
    reference = place_nodes(space, 1, n, slots, numbers, index, q, turn, u, nodes)
    for k in range(n):
        if k != reference:
            to[k - (1 if k > reference else 0)] = node_view(node(nodes, k)).margin[0]
