"""Published problems of solids and shells: a thick cylinder and a sphere under pressure, and a rotating disc."""

import meshio
import numpy as np
import pytest

from stiffmbs.flexible_bodies.areas import unit_loads
from stiffmbs.flexible_bodies.description import Material
from stiffmbs.flexible_bodies.mesh import from_mesh
from stiffmbs.flexible_bodies.reduction import static_solver
from stiffmbs.flexible_bodies.stress import stress_points

from .bars import with_middles

INNER, OUTER, HEIGHT = 0.1, 0.2, 0.02
E, NU, DENSITY = 2.1e11, 0.3, 7850.0


@pytest.fixture(scope="module")
def ring(tmp_path_factory):
    """Return a ring of hexahedra of 20 nodes, whose edges are circles."""
    across, around = 4, 24
    radii, angles = np.linspace(INNER, OUTER, across + 1), np.arange(around) * 2 * np.pi / around
    flat = np.array([(r, a, z) for r in radii for a in angles for z in (0.0, HEIGHT)])
    number = np.arange(len(flat)).reshape(across + 1, around, 2)
    following = np.roll(number, -1, axis=1)
    corners = [number[:-1, :, 0], number[1:, :, 0], following[1:, :, 0], following[:-1, :, 0]]
    corners += [number[:-1, :, 1], number[1:, :, 1], following[1:, :, 1], following[:-1, :, 1]]
    cells = np.stack(corners, axis=-1).reshape(-1, 8)
    places = _round(flat)
    mesh = with_middles(places, "hexahedron", cells, "hexahedron20")
    radius = _radii(mesh.points)
    wanted = INNER + (OUTER - INNER) / (2 * across) * np.round(
        (radius / np.cos(np.pi / around) - INNER) * 2 * across / (OUTER - INNER)
    )
    on_arc = np.abs(radius - wanted * np.cos(np.pi / around)) < 1e-9
    on_arc[: len(places)] = False
    mesh.points[on_arc, :2] /= np.cos(np.pi / around)
    path = tmp_path_factory.mktemp("ring") / "ring.vtu"
    mesh.write(path)
    model = from_mesh(path, 1.0, Material(E=E, nu=NU, density=DENSITY))
    model.check()
    return model


def _round(flat):
    radius, angle, z = flat.T
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])


def _radii(points):
    return np.hypot(points[:, 0], points[:, 1])


def free(model, load):
    """Return the displacements of a free body under forces in equilibrium, shape (nodes, 3), and its stresses at the points."""
    solver, _ = static_solver(model, [], model.rigid_modes(model.nodes.mean(axis=0)))
    moved = solver.held_response(load)
    return moved.reshape(len(model.nodes), -1)[:, :3], stress_points(model).stresses(moved[:, None])[0]


def hoop(model, stress, radius):
    """Return the stresses around the axis at nodes of a radius."""
    x, y, _ = model.nodes.T
    chosen = np.abs(_radii(model.nodes) - radius) < 1e-6
    sine, cosine = y[chosen] / radius, x[chosen] / radius
    xx, yy, _, xy, _, _ = stress[chosen].T
    return xx * sine**2 + yy * cosine**2 - 2 * xy * sine * cosine


def test_a_thick_cylinder_under_pressure(ring):
    """G. Lame (1852); S. P. Timoshenko, J. N. Goodier, Theory of elasticity, section 28: open ends."""
    inside = np.flatnonzero(np.abs(_radii(ring.nodes) - INNER) < 1e-6)
    moved, stress = free(ring, 1e7 * unit_loads(ring, inside, None, 1.0)[:, 0])
    radial = np.einsum("na,na->n", moved[inside, :2], ring.nodes[inside, :2]) / INNER
    square = OUTER**2 - INNER**2
    expected = 1e7 * INNER / (E * square) * ((1 - NU) * INNER**2 + (1 + NU) * OUTER**2)
    np.testing.assert_allclose(radial, expected, rtol=2e-3)
    np.testing.assert_allclose(hoop(ring, stress, INNER), 1e7 * (INNER**2 + OUTER**2) / square, rtol=0.02)
    np.testing.assert_allclose(hoop(ring, stress, OUTER), 2e7 * INNER**2 / square, rtol=0.01)


def test_a_rotating_disc_with_a_hole(ring):
    """S. P. Timoshenko, J. N. Goodier, Theory of elasticity, section 32: 1000 rad/s."""
    middle, gradient = ring.nodes.mean(axis=0), 1e6 * np.diag([1.0, 1.0, 0.0])
    _, stress = free(ring, ring.inertial_forces(np.zeros((3, 1)), gradient[:, :, None], middle)[:, 0])
    scale = DENSITY * 1e6 / 4
    at_hole = scale * ((3 + NU) * OUTER**2 + (1 - NU) * INNER**2)
    at_rim = scale * ((1 - NU) * OUTER**2 + (3 + NU) * INNER**2)
    np.testing.assert_allclose(hoop(ring, stress, INNER), at_hole, rtol=0.01)
    np.testing.assert_allclose(hoop(ring, stress, OUTER), at_rim, rtol=0.01)


def test_a_sphere_under_pressure(tmp_path):
    """Membrane stress p R / (2 t), and radial displacement p R^2 (1 - nu) / (2 E t), of a thin closed shell."""
    n, radius, thickness = 8, 0.5, 2e-3
    axis = np.tan(np.linspace(-np.pi / 4, np.pi / 4, n + 1))
    points, cells = [], []
    for turn in (np.eye(3), np.eye(3)[[1, 2, 0]], np.eye(3)[[2, 0, 1]]):
        for side in (1.0, -1.0):
            a, b = (each.ravel() for each in np.meshgrid(axis, side * axis, indexing="ij"))
            own = np.column_stack([a, b, np.full_like(a, side)]) @ turn
            number = len(points) * (n + 1) ** 2 + np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
            corners = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
            cells.append(np.stack(corners, axis=-1).reshape(-1, 4))
            points.append(radius * own / np.linalg.norm(own, axis=1)[:, None])
    every = np.vstack(points)
    _, first, place = np.unique(every.round(9), axis=0, return_index=True, return_inverse=True)
    meshio.Mesh(every[first], [("quad", place.ravel()[np.vstack(cells)])]).write(tmp_path / "sphere.vtu")
    model = from_mesh(tmp_path / "sphere.vtu", 1.0, Material(E=E, nu=NU, density=DENSITY), thickness=thickness)
    load = -1e6 * unit_loads(model, np.arange(len(model.nodes)), None, 1.0)[:, 0]
    moved, stress = free(model, load)
    radial = np.einsum("na,na->n", moved, model.nodes) / radius
    assert radial.mean() == pytest.approx(1e6 * radius**2 * (1 - NU) / (2 * E * thickness), rel=0.02)
    principal = np.linalg.eigvalsh(np.stack([stress[:, [0, 3, 5]], stress[:, [3, 1, 4]], stress[:, [5, 4, 2]]], axis=1))
    assert principal[:, 1:].mean() == pytest.approx(1e6 * radius / (2 * thickness), rel=0.02)
