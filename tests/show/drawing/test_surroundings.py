"""Roads, floors, wheels and rods of drawings in space."""

from itertools import pairwise

import numpy as np
import pytest

import stiffmbs
from stiffmbs import read_scene
from stiffmbs.roads import CosineBump, FormulaRoad, Iso8608Road, StepRoad, TableRoad
from stiffmbs.show.drawing.derive import drawing_of
from stiffmbs.show.drawing.picture import Shown
from stiffmbs.show.drawing.poses import described_poses, poses_of
from stiffmbs.show.drawing.surroundings import shadows

WHEEL = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  wheel: {mass: 20, inertia: [1, 1.5, 1], position: [0, 0, 0.3], geometry: {type: cylinder, radius: 0.3, length: 0.2, orientation: {z: [0, 1, 0]}}}
forces:
  tyre: {type: vertical_tyre, i: wheel, radius: 0.3, stiffness: 2e5, road: %s}
"""


def drawn(text):
    data = read_scene(text)
    return drawing_of(data, along=described_poses(data))


def floor_of(drawing):
    return next(part for part in drawing.parts if part.role == "floor").solids[0].vertices


@pytest.mark.parametrize(
    ("road", "height"),
    [
        (CosineBump(start=1, length=2, crest=0.1), lambda x, y: np.where((x > 1) & (x < 3), 0.05 * (1 - np.cos(np.pi * (x - 1))), 0)),
        (FormulaRoad(z="0.1*x + 0.2*y"), lambda x, y: 0.1 * x + 0.2 * y),
        (TableRoad(profile=stiffmbs.Table(table=[[0, 0], [2, 0.2], [9, 0.2]], lines=True)), lambda x, y: np.minimum(0.1 * x, 0.2)),
    ],
    ids=["bump", "formula", "table"],
)  # fmt: skip
def test_heights_are_those_of_the_road(road, height):
    x, y = np.meshgrid(np.linspace(0, 4, 41), [-1.0, 0.5], indexing="ij")
    np.testing.assert_allclose(road.heights(x, y), height(x, y), atol=1e-12)


def test_heights_of_two_tracks_differ_across_the_road():
    road = Iso8608Road(roughness="C", track=1.5, length=100, shortest=1)
    x = np.linspace(0, 20, 50)
    left, right = road.heights(x, np.full(50, 0.75)), road.heights(x, np.full(50, -0.75))
    tables = road.in_equations()
    np.testing.assert_allclose(left, np.interp(x, *np.array(tables["left"].table).T), atol=2e-3)
    assert np.abs(left - right).max() > 1e-3


def test_a_wheel_stands_on_its_road():
    """The lowest point of the drawn tyre is on the surface below it, the step is as high as it is."""
    drawing = drawn(WHEEL % "{type: step, start: 0.2, rise: 0.05, length: 0.01}")
    vertices = floor_of(drawing)
    below = np.abs(vertices[:, 0]) < 0.1
    assert below.any() and np.abs(vertices[below, 2]).max() < 1e-12
    assert vertices[:, 2].max() == pytest.approx(0.05)
    tyre = [part for part in drawing.parts if part.owner == "tyre"]
    lowest = min(solid.vertices[:, 2].min() for part in tyre for solid in part.solids)
    assert 0.3 + lowest == pytest.approx(0, abs=2e-3)


def test_a_wheel_has_spokes_in_place_of_its_cylinder():
    drawing = drawn(WHEEL % "{type: flat}")
    assert not [part for part in drawing.parts if part.owner == "wheel"]
    assert len(next(part for part in drawing.parts if part.color == "#c9cdd2").solids) == 6
    smaller = drawn((WHEEL % "{type: flat}").replace("radius: 0.3, length", "radius: 0.1, length"))
    assert [part for part in smaller.parts if part.owner == "wheel"]  # a hub is kept


def test_the_tread_is_closed_and_faces_outwards():
    drawing = drawn(WHEEL % "{type: flat}")
    (tread,) = next(part for part in drawing.parts if part.color == "#4a4a4a").solids
    volume = 0.0
    for face in tread.faces:
        a, *others = tread.vertices[face]
        volume += sum(np.dot(a, np.cross(b, c)) for b, c in pairwise(others)) / 6
    profile = np.array([[0.66, -0.5], [0.95, -0.5], [1.0, -0.3], [1.0, 0.3], [0.95, 0.5], [0.66, 0.5]]) * (
        0.3,
        0.62 * 0.3,
    )
    r, z = profile.T
    after = np.roll(profile, -1, axis=0)
    moment = np.sum((r + after[:, 0]) * 0 + (r**2 + r * after[:, 0] + after[:, 0] ** 2) * (after[:, 1] - z)) / 6
    ring = 32 * np.sin(2 * np.pi / 32) / (2 * np.pi)  # area of a polygon in that of its circle
    assert volume == pytest.approx(2 * np.pi * moment * ring, rel=1e-9)


def test_a_floor_lies_below_the_whole_motion():
    text = """
dimensions: 3
gravity: [0, 0, -9.81]
bodies:
  ball: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [1, 0, 0], geometry: {type: sphere, radius: 0.2}}
joints:
  pin: {type: revolute, i: {body: ball, point: [-1, 0, 0], orientation: {z: [0, 1, 0]}}, j: {body: ground, orientation: {z: [0, 1, 0]}}}
run: {duration: 1, points: 200}
"""
    data = read_scene(text)
    run = stiffmbs.run(data)
    poses = poses_of(data, run.time, run.channels)
    drawing = drawing_of(data, along=poses)
    levels = np.unique(floor_of(drawing)[:, 2])
    assert len(levels) == 1 and levels[0] == pytest.approx(run["ball.z"].min() - 0.2, abs=0.03)
    for outline in shadows(drawing, poses, 0):
        assert np.ptp(outline[:, 2]) == 0
    assert not [part for part in drawn(text.replace("gravity: [0, 0, -9.81]", "")).parts if part.role == "floor"]


def test_bodies_without_shapes_are_rods_between_their_points():
    text = """
dimensions: 3
bodies:
  arm:
    mass: 1
    inertia: [1, 1, 1]
    markers: {a: {point: [0, 0, 0]}, b: {point: [1, 0, 0]}, c: {point: [0, 1, 0]}}
"""
    part = next(part for part in drawn(text).parts if part.owner == "arm")
    points = np.vstack([solid.vertices for solid in part.solids])
    for middle in ((0.5, 0, 0), (0, 0.5, 0), (0.5, 0.5, 0)):
        along = points - middle
        assert np.linalg.norm(along, axis=1).min() < 0.8  # a rod passes there
    assert not (np.linalg.norm(points - (0.33, 0.33, 0), axis=1) < 0.1).any()  # no plate


@pytest.mark.long
def test_forces_are_shown_in_the_plane_by_default():
    for text, seen in (
        (WHEEL % "{type: flat}", False),
        ("bodies: {a: {mass: 1, inertia: 1}}\nforces: {f: {type: force, i: a, force: [1, 0]}}", True),
    ):
        data = read_scene(text)
        run = stiffmbs.run(data, duration=0.1)
        poses = poses_of(data, run.time, run.channels)
        drawing = drawing_of(data)
        assert bool(Shown().longest(drawing, poses)) == seen
        assert Shown(forces=True).longest(drawing, poses) > 0 and Shown(forces=False).longest(drawing, poses) == 0


def test_a_road_without_numbers_is_left_out():
    import sympy

    from stiffmbs.roads import Road

    class Own(Road):
        kind = "own_without_numbers"

        @staticmethod
        def height(r, x, y):
            return sympy.cos(x) * 0

    data = read_scene(WHEEL % "{type: flat}")
    tyre = data.forces["tyre"].model_copy(update={"road": Own()})
    data = data.model_copy(update={"forces": {"tyre": tyre}})
    assert not [part for part in drawing_of(data, along=described_poses(data)).parts if part.role == "floor"]


def test_a_step_is_not_smoothed():
    road = StepRoad(start=1, rise=0.05, length=0.01)
    assert road.heights(np.array([0.99, 1.02]), np.zeros(2)).tolist() == pytest.approx([0, 0.05])
