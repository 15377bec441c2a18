"""Shapes of beams in drawings: their cross sections about the axis, in one color, in place of a line."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.elements.spatial.orientation import IDENTITY
from stiffmbs.model.beams.section import Angle, Channel, IProfile, Rectangle
from stiffmbs.show.drawing.derive import drawing_of
from stiffmbs.show.drawing.solids import rotation

SECTIONS = {
    "circle": "{type: circle, diameter: 60 mm}",
    "tube": "{type: tube, diameter: 60 mm, thickness: 4 mm}",
    "rectangle": "{type: rectangle, width: 40 mm, height: 70 mm}",
    "i": "{type: i, width: 80 mm, height: 120 mm, flange: 10 mm, web: 8 mm}",
    "l": "{type: l, width: 80 mm, height: 120 mm, thickness: 10 mm}",
    "u": "{type: u, width: 80 mm, height: 120 mm, flange: 10 mm, web: 8 mm}",
}
KINDS = {
    "rectangle": Rectangle(width=0.04, height=0.07),
    "i": IProfile(width=0.08, height=0.12, flange=0.01, web=0.008),
    "l": Angle(width=0.08, height=0.12, thickness=0.01),
    "u": Channel(width=0.08, height=0.12, flange=0.01, web=0.008),
}
HEIGHTS = {"circle": 0.06, "tube": 0.06, "rectangle": 0.07, "i": 0.12}


def model(section, axis="end: [1.2, 0.9, 0]", dimensions=3):
    steel = "E: 206 GPa, density: 7850 kg/m^3"
    return stiffmbs.read_scene(
        f"dimensions: {dimensions}\nbodies:\n  bar: {{type: beam, start: {[0] * dimensions}, {axis}, elements: 4, section: {section}, "
        f"material: {{{steel}}}}}\n  other: {{mass: 1, inertia: {1 if dimensions == 2 else [1, 1, 1]}}}\n"
    )


def volume_and_moments(body):
    """Volume, its centre, and its second moments in the axes of the body, of boxes alone."""
    volume, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for shape in body.geometry:
        size, middle = np.array(shape.size), np.array(shape.point)
        axes = rotation(np.array(shape.orientation or IDENTITY))
        own = np.prod(size)
        volume += own
        first += own * middle
        second += own * (np.outer(middle, middle) + axes @ np.diag(size**2 / 12) @ axes.T)
    return volume, first / volume, second


@pytest.mark.parametrize("name", KINDS)
def test_boxes_have_the_area_the_centroid_and_the_moments_of_the_section(name):
    scene = model(SECTIONS[name])
    of = KINDS[name].properties(0.3)
    length = 1.5 / 4
    for body in list(scene.bodies.values())[1:-2]:
        volume, centre, second = volume_and_moments(body)
        assert volume == pytest.approx(of.A * length, rel=1e-9)
        assert np.abs(centre).max() < 1e-12
        assert second[1:, 1:] / length == pytest.approx(
            np.array([[of.I3, of.I23], [of.I23, of.I2]]), rel=1e-9, abs=1e-15
        )


@pytest.mark.parametrize("name", ["circle", "tube"])
def test_round_sections_are_cylinders_along_the_axis(name):
    scene = model(SECTIONS[name], "through: [0.6, 0.1, 0], end: [1.2, 0, 0]")
    for body in list(scene.bodies.values())[1:-2]:
        assert len(body.geometry) == 2
        ends = []
        for shape in body.geometry:
            assert (shape.type, shape.radius) == ("cylinder", 0.03)
            axis = rotation(np.array(shape.orientation))[:, 2]
            ends.append([np.array(shape.point) + part * shape.length / 2 * axis for part in (-1, 1)])
        assert ends[0][1] == pytest.approx(ends[1][0], abs=1e-12) and np.abs(ends[0][1]).max() < 1e-12  # at the node
        assert rotation(np.array(body.geometry[0].orientation))[0, 2] > 0.99


@pytest.mark.parametrize("name", HEIGHTS)
def test_planar_beams_have_the_height_of_their_section(name):
    scene = model(SECTIONS[name], "end: [1.2, 0.9]", 2)
    for body in list(scene.bodies.values())[1:-2]:
        (shape,) = body.geometry
        x, y = np.array(shape.points).T
        assert shape.closed and np.ptp(y) == pytest.approx(HEIGHTS[name]) and np.ptp(x) == pytest.approx(1.5 / 4)
        assert abs(y.max() + y.min()) < 1e-12


def test_sections_of_unknown_form_are_lines():
    scene = model("{type: numbers, A: 1e-3, I2: 1e-6}")
    assert {shape.type for body in list(scene.bodies.values())[:-1] for shape in body.geometry} == {"polyline"}
    assert len(drawing_of(scene).links) == 4


def test_a_beam_has_one_color_and_no_line_inside():
    drawing = drawing_of(model(SECTIONS["i"]))
    colors = {name: color for name, color in drawing.bodies.items() if name.startswith("bar.")}
    assert len(colors) == 5 and len(set(colors.values())) == 1
    assert drawing.bodies["other"] != colors["bar.start"]
    assert not drawing.links


@pytest.mark.parametrize("name", ["tube", "i"])
@pytest.mark.parametrize("turn", [30, 90, 150, 179])
def test_a_corner_has_the_shapes_of_both_legs(name, turn):
    """In the plane of the corner the height keeps its direction."""
    x, y = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    scene = stiffmbs.read_scene(
        f"dimensions: 3\nbodies:\n  bar: {{type: beam, points: [[0, 0, 0], [1, 0, 0], [{1 + x}, {y}, 0]], elements: 4, section: {SECTIONS[name]}, "
        "material: {E: 206 GPa, density: 7850 kg/m^3}}\n"
    )
    corner = next(body for body in scene.bodies.values() if np.allclose(body.position, [1, 0, 0]))
    ways = set()
    for shape in corner.geometry:
        axes = rotation(np.array(corner.orientation)) @ rotation(np.array(shape.orientation))
        ways.add(tuple(np.round(axes[:, 2 if shape.type == "cylinder" else 0], 9) + 0.0))
        if shape.type == "box":
            assert axes[2, 2] == pytest.approx(1, abs=1e-9)
    assert ways == {(1, 0, 0), (round(x, 9) + 0.0, round(y, 9) + 0.0, 0)}
