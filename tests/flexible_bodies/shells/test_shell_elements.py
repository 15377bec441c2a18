"""Shell elements: constant strains on any mesh, published plates and shells, thin limits, and arrangements that change nothing."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from stiffmbs.flexible_bodies.finite_elements import rigid_motions
from stiffmbs.flexible_bodies.shells.curvature import coarseness

from .meshes import KINDS, places, pressure, shell, surface, under
from .published import BEAMS, PROBLEMS, hemisphere, square, straight_beam

E, NU, THICK = 1e6, 0.3, 0.02
ALL = range(6)
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


PLATES = "simple plate, pressure", "clamped plate, pressure", "simple plate, frequency", "clamped plate, frequency"


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", PLATES)
def test_errors_of_a_thin_plate_fall_to_a_quarter_with_twice_as_many_elements(name, kind):
    coarse, fine = (PROBLEMS[name](kind, n) - 1 for n in (8, 16))
    assert abs(fine) < 0.009
    assert coarse / fine == pytest.approx(4.0, abs=0.6)


@pytest.mark.parametrize("thickness", [0.2, 1e-2, 1e-5])
@pytest.mark.parametrize("kind", KINDS)
def test_shear_and_the_thin_limit(kind, thickness):
    """Reissner and Mindlin's plate: that of Kirchhoff, and the deflection of a membrane by shear."""
    of, held, grid = square(kind, 16, thickness)
    modulus = of.materials.modulus[0]
    shear, bending = 5 / 6 * modulus / (2 * (1 + NU)) * thickness, modulus * thickness**3 / (12 * (1 - NU**2))
    found = under(of.stiffness(), held, pressure(of, [0, 0, 1]))[grid[8, 8], 2]
    assert found == pytest.approx(0.00406235 / bending + 0.0736713 / shear, rel=5e-3)


CASES = {
    "cantilever plate, frequencies": (16, 1.0, 8e-3), "Scordelis-Lo roof": (8, 1.0, 0.01), "pinched cylinder": (16, 1.0, 0.02),
    "twisted beam": (2, 1.0, 6e-3), "thin twisted beam": (2, 1.0, 6e-3), "straight beam, in its plane": (1, 1.0, 0.01),
    "straight beam, out of its plane": (1, 1.0, 0.025),
}  # fmt: skip
TRIANGLES = {"thin twisted beam": (8, 0.9, 0.01), "straight beam, in its plane": (1, 1.05, 0.01)}
"""Triangles on surfaces with two curvatures need small elements."""


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", CASES)
def test_a_published_value(name, kind):
    n, expected, error = TRIANGLES.get(name, CASES[name]) if kind == "triangle" else CASES[name]
    np.testing.assert_allclose((PROBLEMS | BEAMS)[name](kind, n), expected, rtol=error)


@pytest.mark.parametrize(("kind", "expected"), [("quad", 0.258), ("triangle", 0.477)])
def test_a_single_row_of_trapezoids_is_too_stiff_in_its_plane(kind, expected):
    """MacNeal and Harder's trapezoids, with sides inclined by 45 deg; elements with displacements alone reach 0.03."""
    assert straight_beam(kind, 1, 1, inclined=1.0) == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize(("n", "expected"), [(8, 0.49), (16, 0.93), (32, 0.99)])
@pytest.mark.parametrize("kind", KINDS)
def test_a_surface_with_two_curvatures_needs_elements_below_the_root_of_radius_and_thickness(n, expected, kind):
    """The root is 0.63, the elements have sides of up to 15.7 / n."""
    assert hemisphere(kind, n) == pytest.approx(expected, abs=0.02)


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


@pytest.mark.parametrize("kind", KINDS)
def test_coarse_elements_of_a_surface_with_two_curvatures_are_noted(kind):
    """h^2 / (R t) of a sphere's zone is known; cylinders and folds have no such curvature."""

    def zone(a, b):
        polar, azimuth = np.pi / 2 + 0.4 * (b - 0.5), 0.4 * a
        return np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)

    for n in (4, 8):
        nodes, cells, _ = surface(n, n, zone, kind)
        found = coarseness(shell(nodes, cells, E, NU, 0.01), cells.values())
        assert found == pytest.approx((0.4 / n) ** 2 / 0.01, rel=0.03)
    for place in (lambda a, b: (np.cos(a), np.sin(a), b), lambda a, b: (a, min(b, 0.5), max(b - 0.5, 0))):
        nodes, cells, _ = surface(8, 8, place, kind)
        assert coarseness(shell(nodes, cells, E, NU, 1e-3), cells.values()) < 1e-3
