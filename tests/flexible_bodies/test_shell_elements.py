"""Shell elements: constant strains on any mesh, published plates and shells, thin limits, and arrangements that change nothing."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from stiffmbs.flexible_bodies.finite_elements import rigid_motions

from .shells import KINDS, frequencies, places, pressure, shell, surface, under

E, NU, THICK = 1e6, 0.3, 0.02
MEMBRANE, ROTATIONS, ALL = [0, 1, 5], [3, 4, 5], range(6)
PATCH = np.array([[0, 0], [0.24, 0], [0.24, 0.12], [0, 0.12], [0.04, 0.02], [0.18, 0.03], [0.16, 0.08], [0.08, 0.08]])
"""Patch of R. H. MacNeal and R. L. Harder, A proposed standard set of problems, Finite Elem. Anal. Des. 1 (1985) 3-20."""
QUADS = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]])
TURN = Rotation.from_rotvec([0.4, -0.7, 0.3]).as_matrix()


def patch(kind, turn=TURN):
    nodes = np.column_stack([PATCH, np.zeros(8)]) @ turn.T
    cells = {"quad": QUADS} if kind == "quad" else {"triangle": np.vstack([QUADS[:, :3], QUADS[:, [0, 2, 3]]])}
    if kind == "both":
        cells = {"quad": QUADS[:3], "triangle": np.vstack([QUADS[3:, :3], QUADS[3:, [0, 2, 3]]])}
    return nodes, cells


def turned(field, turn=TURN):
    """Return components in the axes of the plane as those of the mesh."""
    return (field.reshape(-1, 2, 3) @ turn.T).ravel()


@pytest.mark.parametrize("thickness", [1e-4, 1e-3, 0.05])
@pytest.mark.parametrize("kind", [*KINDS, "both"])
def test_constant_membrane_strains_and_curvatures_are_exact_on_a_distorted_patch(kind, thickness):
    nodes, cells = patch(kind)
    x, y = PATCH.T
    membrane, plate = np.zeros((2, 8, 6))
    a, b, c, d = 1e-3 * np.array([1.0, 0.5, -0.7, 0.3])
    membrane[:, 0], membrane[:, 1], membrane[:, 5] = a * x + b * y, c * x + d * y, (c - b) / 2
    plate[:, 2] = (x**2 + x * y + y**2) / 2e3
    plate[:, 3], plate[:, 4] = (x + 2 * y) / 2e3, -(2 * x + y) / 2e3  # of a normal without shear strain
    of = shell(nodes, cells, E, NU, thickness)
    K, area, inner = of.stiffness(), 0.24 * 0.12, places(range(4, 8), ALL)
    plane = E / (1 - NU**2) * np.array([[1, NU, 0], [NU, 1, 0], [0, 0, (1 - NU) / 2]])
    for field, strain, size in (
        (membrane, np.array([a, d, b + c]), thickness), (plate, np.array([1, 1, 1]) / 1e3, thickness**3 / 12)
    ):  # fmt: skip
        components = turned(field)
        force = K @ components
        assert components @ force / 2 == pytest.approx(area * size * strain @ plane @ strain / 2, rel=1e-9)
        assert np.abs(force[inner]).max() < 1e-13 * (abs(K) @ np.abs(components)).max()  # of rounding alone


@pytest.mark.parametrize("kind", KINDS)
def test_an_element_has_six_motions_without_strain(kind):
    """Also a warped one: nodes at random."""
    random = np.random.default_rng(3)
    nodes = random.standard_normal((4 if kind == "quad" else 3, 3)) * [0.1, 0.1, 0.02]
    nodes[:, :2] += [[0, 0], [1, 0], [1, 1], [0, 1]][: len(nodes)]
    K = shell(nodes, {kind: np.arange(len(nodes))[None]}, E, NU, 0.1).stiffness()
    values = np.linalg.eigvalsh(K.toarray())
    assert np.abs(values[:6]).max() < 1e-12 * values[-1] < values[6] * 1e-6
    assert np.abs(K @ rigid_motions(nodes, 6)).max() < 1e-12 * np.abs(K).max()


@pytest.mark.parametrize("ratio", [0.25, 1.0, 8.0])
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
@pytest.mark.parametrize("kind", KINDS)
def test_bending_in_the_plane_is_exact_in_a_rectangle_of_any_shape(kind, nu, ratio):
    """What the membrane OPT is made for (Felippa 2003): displacements u = x y, v = -x^2 / 2 - nu y^2 / 2."""
    nodes, cells, _ = surface(1, 1, lambda a, b: (ratio * (a - 0.5), b - 0.5, 0), kind)
    x, y, _ = nodes.T
    field = np.zeros((4, 6))
    field[:, 0], field[:, 1], field[:, 5] = x * y, -(x**2) / 2 - nu * y**2 / 2, -x
    energy = field.ravel() @ (shell(nodes, cells, 1.0, nu, 1.0).stiffness() @ field.ravel()) / 2
    assert energy == pytest.approx(ratio / 24, rel=1e-9)


def square(kind, n, thickness=1e-3, simple=True):
    """Return a square plate of side 1, held in its plane, with the components of a simple or a clamped support."""
    nodes, cells, grid = surface(n, n, lambda a, b: (a, b, 0), kind)
    edges = grid[[0, -1]], grid[:, [0, -1]]
    held = [places(grid, MEMBRANE), *(places(edge, [2]) for edge in edges)]
    for edge, across in zip(edges, (3, 4), strict=True):  # a simple support holds the rotation across the edge
        held.append(places(edge, [across] if simple else [3, 4]))
    return shell(nodes, cells, 1e7, NU, thickness), np.unique(np.concatenate(held)), grid


def plate_stiffness(thickness):
    return 1e7 * thickness**3 / (12 * (1 - NU**2))


PLATES = {
    "simply supported": (True, 0.00406235, 2 * np.pi**2),  # Timoshenko & Woinowsky-Krieger, table 8
    "clamped": (False, 0.00126532, 35.985),  # their table 35; Leissa, NASA SP-160, table 4.22
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("support", PLATES)
def test_a_thin_square_plate(support, kind):
    """Deflection under pressure and lowest frequency; the error falls to a quarter with twice as many elements."""
    simple, deflection, frequency = PLATES[support]
    errors = []
    for n in (8, 16):
        of, held, grid = square(kind, n, simple=simple)
        D = plate_stiffness(1e-3)
        found = under(of.stiffness(), held, pressure(of, [0, 0, 1]))[grid[n // 2, n // 2], 2] * D / deflection
        errors.append([found - 1, frequencies(of, held, 1)[0] * np.sqrt(1e-3 / D) / frequency - 1])
    assert np.abs(errors[1]).max() < 0.009
    np.testing.assert_allclose(np.array(errors[0]) / errors[1], 4.0, atol=0.6)


@pytest.mark.parametrize("thickness", [0.2, 1e-2, 1e-5])
@pytest.mark.parametrize("kind", KINDS)
def test_shear_and_the_thin_limit(kind, thickness):
    """Reissner and Mindlin's plate: that of Kirchhoff, and the deflection of a membrane by shear."""
    of, held, grid = square(kind, 16, thickness)
    shear = 5 / 6 * 1e7 / (2 * (1 + NU)) * thickness
    expected = 0.00406235 / plate_stiffness(thickness) + 0.0736713 / shear
    found = under(of.stiffness(), held, pressure(of, [0, 0, 1]))[grid[8, 8], 2]
    assert found == pytest.approx(expected, rel=5e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_frequencies_of_a_cantilever_plate(kind):
    """A. Leissa, The free vibration of rectangular plates, J. Sound Vib. 31 (1973) 257-293: square, nu = 0.3."""
    nodes, cells, grid = surface(16, 16, lambda a, b: (a, b, 0), kind)
    held = np.concatenate([places(grid[0], ALL), places(grid, MEMBRANE)])
    found = frequencies(shell(nodes, cells, 1e7, NU, 1e-3), held, 5) * np.sqrt(1e-3 / plate_stiffness(1e-3))
    np.testing.assert_allclose(found, [3.4917, 8.5246, 21.429, 27.331, 31.111], rtol=8e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_the_scordelis_lo_roof(kind):
    """A quarter, with its diaphragm; 0.3024 is the customary value (MacNeal & Harder 1985), thick shells have 0.3008."""
    arc = np.radians(40)
    nodes, cells, grid = surface(8, 8, lambda a, b: (25 * np.sin(arc * b), 25 * a, 25 * np.cos(arc * b)), kind)
    of = shell(nodes, cells, 4.32e8, 0.0, 0.25)
    held = [places(grid[0], [1, 3, 5]), places(grid[-1], [0, 2]), places(grid[:, 0], [0, 4, 5])]
    found = under(of.stiffness(), np.concatenate(held), pressure(of, [0, 0, -90]))
    assert -found[grid[0, -1], 2] == pytest.approx(0.3024, rel=0.01)


@pytest.mark.parametrize(("n", "error"), [(8, 0.12), (16, 0.02)])
@pytest.mark.parametrize("kind", KINDS)
def test_a_pinched_cylinder(kind, n, error):
    """An eighth, with rigid diaphragms; 1.8248e-5 (T. Belytschko et al., Comput. Methods Appl. Mech. Eng. 51 (1985) 221-258)."""
    nodes, cells, grid = surface(
        n, n, lambda a, b: (300 * np.sin(np.pi / 2 * b), 300 * a, 300 * np.cos(np.pi / 2 * b)), kind
    )
    held = [
        places(grid[0], [1, 3, 5]),
        places(grid[-1], [0, 2]),
        places(grid[:, 0], [0, 4, 5]),
        places(grid[:, -1], [2, 3, 4]),
    ]
    force = np.zeros(6 * len(nodes))
    force[6 * grid[0, 0] + 2] = -0.25
    found = under(shell(nodes, cells, 3e6, NU, 3.0).stiffness(), np.concatenate(held), force)
    assert -found[grid[0, 0], 2] == pytest.approx(1.8248e-5, rel=error)


TWISTED = {0.32: (1.0, 5.424e-3, 1.754e-3), 0.0032: (1e-6, 5.256e-3, 1.294e-3)}
"""Thickness; force, and its displacement in the plane and out of the plane of the end (MacNeal & Harder; Belytschko et al. 1989)."""


@pytest.mark.parametrize("thickness", TWISTED)
def test_a_twisted_beam(thickness):
    """Twisted by a quarter of a turn; its quadrilaterals are warped."""
    force, *expected = TWISTED[thickness]

    def place(a, b):
        angle, y = np.pi / 2 * a, 1.1 * (b - 0.5)
        return 12 * a, y * np.cos(angle), y * np.sin(angle)

    nodes, cells, grid = surface(12, 2, place)
    K = shell(nodes, cells, 29e6, 0.22, thickness).stiffness()
    for axis, displacement in zip((2, 1), expected, strict=True):
        forces = np.zeros(6 * len(nodes))
        forces[6 * grid[-1, 1] + axis] = force
        found = under(K, places(grid[0], ALL), forces)
        assert found[grid[-1, 1], axis] == pytest.approx(displacement, rel=6e-3)


@pytest.mark.parametrize(("n", "expected"), [(8, 0.49), (16, 0.93), (32, 0.99)])
def test_a_hemisphere_needs_elements_of_twice_the_root_of_radius_and_thickness(n, expected):
    """MacNeal and Harder's, with a hole of 18 deg: 0.0940. Coarse elements with two curvatures are too stiff."""
    nodes, cells, grid = surface(
        n, n, lambda a, b: 10 * np.array(
            [np.sin(p := np.radians(18 + 72 * b)) * np.cos(np.pi / 2 * a), np.sin(p) * np.sin(np.pi / 2 * a), np.cos(p)]
        )
    )  # fmt: skip
    one, other = grid[0, -1], grid[-1, -1]
    held = [places(grid[0], [1, 3, 5]), places(grid[-1], [0, 4, 5]), places(one, [2])]
    force = np.zeros(6 * len(nodes))
    force[6 * one], force[6 * other + 1] = 1.0, -1.0
    found = under(shell(nodes, cells, 6.825e7, NU, 0.04).stiffness(), np.concatenate(held), force)
    assert found[one, 0] / 0.0940 == pytest.approx(expected, abs=0.01)


@pytest.mark.parametrize(("axis", "expected", "error"), [(0, 3e-5, 0.01), (1, 0.1081, 0.01), (2, 0.4321, 0.025)])
def test_a_straight_cantilever_of_six_elements(axis, expected, error):
    """MacNeal and Harder's slender beam: extension, bending in its plane and out of it."""
    nodes, cells, grid = surface(6, 1, lambda a, b: (6 * a, 0.2 * b, 0))
    force = np.zeros(6 * len(nodes))
    force[6 * grid[-1] + axis] = 0.5
    found = under(shell(nodes, cells, 1e7, NU, 0.1).stiffness(), places(grid[0], ALL), force)
    np.testing.assert_allclose(found[grid[-1], axis].mean(), expected, rtol=error)


@pytest.mark.parametrize("kind", KINDS)
def test_axes_order_of_nodes_and_side_of_the_normals_change_nothing(kind):
    """A twisted strip: turned, with elements that begin at other corners and run the other way around."""
    nodes, cells, _ = surface(3, 2, lambda a, b: (a, 0.5 * b * np.cos(a), 0.5 * b * np.sin(a)), kind)
    of, own = shell(nodes, cells, E, NU, THICK, 7.0), cells[kind]
    random = np.random.default_rng(1)
    other = np.array([np.roll(each, random.integers(4))[:: random.choice([-1, 1])] for each in own])
    order = random.permutation(len(nodes))
    renumbered = np.argsort(order)[other]
    moved = shell(nodes[order] @ TURN.T + [1, 2, 3], {kind: renumbered}, E, NU, THICK, 7.0)
    by_order = places(order, ALL)
    turn = np.kron(np.eye(2 * len(nodes)), TURN)
    for matrix, another in ((of.stiffness(), moved.stiffness()), (of.mass(), moved.mass())):
        expected = turn @ matrix.toarray()[np.ix_(by_order, by_order)] @ turn.T
        np.testing.assert_allclose(another.toarray(), expected, atol=1e-10 * np.abs(expected).max())
