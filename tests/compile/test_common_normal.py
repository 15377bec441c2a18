"""The common normal of two solids as kernels have it, against distances found without it."""

from itertools import product

import numpy as np
import pytest
from scipy.optimize import brentq, least_squares
from scipy.spatial.transform import Rotation

from stiffmbs.compile.machine.compiler import compiled_source

SOURCE = f"""from stiffmbs.compile.machine.geometry.common_normal import common_normal, common_normal_slope


def normal(pose, found):
    for k in range(1):
        {"; ".join(f"found[{k}] = common_normal({k}, {', '.join(f'pose[{n}]' for n in range(30))})" for k in range(3))}


def slope(by, pose, n, found):
    for k in range(1):
        {"; ".join(f"found[{k}] = common_normal_slope({k}, by, n[0], n[1], n[2], {', '.join(f'pose[{n}]' for n in range(30))})" for k in range(3))}
"""
ROUNDING = 1e-4


@pytest.fixture(scope="module")
def normal():
    call = compiled_source(SOURCE, "normal", "void(float64*, float64*)").call

    def of(pose):
        found = np.zeros(3)
        call(pose.ctypes.data, found.ctypes.data)
        return found

    return of


@pytest.fixture(scope="module")
def slope():
    call = compiled_source(SOURCE, "slope", "void(int64, float64*, float64*, float64*)").call

    def of(by, pose, n):
        found = np.zeros(3)
        call(by, pose.ctypes.data, n.ctypes.data, found.ctypes.data)
        return found

    return of


def ellipsoid(*semi):
    return np.array([*semi, 0, 0, 0, 0, 0, 0], float) ** 2


def box(*halves):
    edge = ROUNDING * min(halves)
    return np.array([halves[k] - 2 * edge if k == row else edge for row in range(3) for k in range(3)]) ** 2


def cylinder(radius, half):
    edge = ROUNDING * min(radius, half)
    across, along = radius - edge, half - edge
    return np.array([across, across, edge, edge, edge, along, 0, 0, 0]) ** 2


def posed(way, axes, first, second):
    return np.concatenate([way, np.ravel(axes), first, second])


def gap(normal, way, axes, first, second):
    n = normal(posed(way, axes, first, second))

    def reach(solid, along):
        return np.sqrt(solid.reshape(3, 3) @ along**2).sum()

    return way @ n - reach(first, axes.T @ n) - reach(second, n)


def distance_to_ellipsoid(point, semi):
    """By the root of the secular equation; Eberly, Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid (2013)."""
    squares = semi**2
    at = brentq(lambda s: np.sum((semi * point / (s + squares)) ** 2) - 1, 0, 100, xtol=1e-15, rtol=1e-15)
    return np.linalg.norm(point - squares * point / (at + squares))


@pytest.mark.parametrize("aspect", [1.0, 3.0, 20.0, 200.0])
def test_a_sphere_and_an_ellipsoid_are_as_far_apart_as_the_secular_equation_says(normal, aspect):
    rng = np.random.default_rng(int(aspect))
    for _ in range(20):
        semi = 0.3 * np.array([1, 1 / np.sqrt(aspect), 1 / aspect])
        on_surface = semi * (way := rng.normal(size=3)) / np.linalg.norm(way)
        outwards = on_surface / semi**2
        point = on_surface + rng.choice([1e-3, 0.1, 2.0]) * outwards / np.linalg.norm(outwards)
        found = gap(normal, point, np.eye(3), ellipsoid(0.05, 0.05, 0.05), ellipsoid(*semi))
        assert found == pytest.approx(distance_to_ellipsoid(point, semi) - 0.05, abs=1e-13)


def test_two_ellipsoids_are_as_far_apart_as_their_nearest_points(normal):
    rng = np.random.default_rng(1)
    for _ in range(5):
        axes, way = Rotation.random(random_state=rng).as_matrix(), 0.6 * np.array([1, rng.normal(), rng.normal()])
        one, other = rng.uniform(0.03, 0.3, (2, 3))

        def between(points, axes=axes, way=way, one=one, other=other):
            u, v = points.reshape(2, 3) / np.linalg.norm(points.reshape(2, 3), axis=1)[:, None]
            return way + axes @ (one * u) - other * v

        starts = (np.concatenate([-way, way]) + rng.normal(0, 0.2, 6) for _ in range(3))
        tries = [least_squares(between, start, xtol=1e-15, ftol=1e-15, gtol=1e-15).cost for start in starts]
        found = gap(normal, way, axes, ellipsoid(*one), ellipsoid(*other))
        assert found == pytest.approx(np.sqrt(2 * min(tries)), abs=1e-9)


def overlap_of_boxes(way, axes, first, second):
    """Minus the least overlap along the 15 axes that can part two boxes; Gottschalk, Lin, Manocha, OBBTree (1996)."""
    directions = [*np.eye(3), *axes.T, *(np.cross(a, b) for a, b in product(np.eye(3), axes.T))]
    units = [d / np.linalg.norm(d) for d in directions if np.linalg.norm(d) > 1e-6]
    return max(abs(way @ u) - first @ abs(axes.T @ u) - second @ abs(u) for u in units)


def test_boxes_overlap_as_by_the_axes_that_part_them(normal):
    """Of random boxes, with all kinds of contact: corners in faces, and edges across edges."""
    rng = np.random.default_rng(3)
    for _ in range(40):
        axes, (first, second) = Rotation.random(random_state=rng).as_matrix(), rng.uniform(0.05, 0.3, (2, 3))
        way = rng.normal(size=3)
        for _ in range(8):  # towards a depth of some hundredths of the least size
            way *= 1 - (overlap_of_boxes(way, axes, first, second) + 0.03 * min(*first, *second)) / np.linalg.norm(way)
        expected = overlap_of_boxes(way, axes, first, second)
        found = gap(normal, way, axes, box(*first), box(*second))
        assert found == pytest.approx(expected, abs=8 * ROUNDING * max(*first, *second))


def test_a_box_just_over_the_edge_of_a_plate_is_on_its_face(normal):
    """The way up parts them sooner than the way out, whatever parts of their sizes these ways are."""
    for depth in (1e-4, 0.01, 0.02):
        found = gap(normal, np.array([1.1, 0, 0.15 - depth]), np.eye(3), box(0.15, 0.1, 0.05), box(1, 0.5, 0.1))
        assert found == pytest.approx(-depth, abs=2e-5)


@pytest.mark.parametrize(
    ("axes", "way", "expected"),
    [
        (Rotation.from_rotvec([0.9, 0, 0]).as_matrix(), [0.44, 0.1, 0.05], 0.44 - 0.3),  # mantles across each other
        (np.eye(3), [0.3, 0, 0.1], 0.0),  # side by side
        (np.eye(3), [0.1, 0.05, 1.1], 0.1),  # end over end
        (Rotation.from_rotvec([0, np.pi / 2, 0]).as_matrix(), [0.2, 0, 0.65], 0.05),  # lying on an end
    ],
)
def test_cylinders_as_they_lie(normal, axes, way, expected):
    found = gap(normal, np.array(way), axes, cylinder(0.1, 0.5), cylinder(0.2, 0.5))
    assert found == pytest.approx(expected, abs=1e-4)


def test_faces_touch_in_their_middles_at_their_places(normal):
    for solid in (box(0.1, 0.2, 0.3), cylinder(0.2, 0.3), ellipsoid(0.1, 0.2, 0.3)):
        assert gap(normal, np.array([0, 0, 0.7]), np.eye(3), solid, box(1, 2, 0.4)) == pytest.approx(0, abs=1e-15)


def test_slopes_are_those_of_the_normal(normal, slope):
    rng = np.random.default_rng(5)
    solids = (box(0.1, 0.2, 0.15), cylinder(0.1, 0.2), ellipsoid(0.1, 0.2, 0.05))
    for first, second in product(solids, solids):
        pose = posed(rng.normal(size=3), Rotation.random(random_state=rng).as_matrix(), first, second)
        n = normal(pose)
        for by in range(30):
            if pose[by] == 0:
                continue
            step = 1e-6 * (1 if by < 12 else pose[by])
            changed = [pose + sign * step * np.eye(30)[by] for sign in (1, -1)]
            expected = (normal(changed[0]) - normal(changed[1])) / (2 * step)
            noise = 1e-9 / step
            np.testing.assert_allclose(slope(by, pose, n), expected, rtol=1e-3, atol=noise * 1e-3 + 1e-6)


def test_it_is_safe_where_middles_coincide(normal):
    assert np.linalg.norm(normal(posed(np.zeros(3), np.eye(3), box(1, 1, 1), box(1, 2, 3)))) == pytest.approx(1)
