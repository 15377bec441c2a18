"""Sections drawn by points against closed forms."""

import math

import pytest

from stiffmbs import InputError, read_scene
from stiffmbs.model.beams.section import Drawn, Rectangle

SQUARE = ((-1, -1), (1, -1), (1, 1), (-1, 1))


def scaled(points, *factors):
    return [[x * factors[0], y * factors[-1]] for x, y in points]


@pytest.mark.long
def test_a_drawn_rectangle_and_a_box_have_their_constants():
    pytest.importorskip("sectionproperties")
    drawn = Drawn(points=scaled(SQUARE, 0.01, 0.025)).properties(0.3)
    plain = Rectangle(width=0.02, height=0.05).properties(0.3)
    for name in ("A", "I2", "I3", "J", "shear2", "shear3"):
        assert getattr(drawn, name) == pytest.approx(getattr(plain, name), rel=1e-3)
    box = Drawn(points=scaled(SQUARE, 0.05), holes=[scaled(SQUARE, 0.049)]).properties(0.3)
    assert pytest.approx((0.1**4 - 0.098**4) / 12, rel=1e-9) == box.I2
    assert pytest.approx(4 * 0.099**4 * 0.001 / (4 * 0.099), rel=2e-2) == box.J  # Bredt


@pytest.mark.long
def test_bad_drawings_are_reported():
    pytest.importorskip("sectionproperties")
    L = [[0, 0], [0.05, 0], [0.05, 0.005], [0.005, 0.005], [0.005, 0.05], [0, 0.05]]
    U = [[0, 0], [0.05, 0], [0.05, 0.005], [0.005, 0.005], [0.005, 0.045], [0.05, 0.045], [0.05, 0.05], [0, 0.05]]
    beam = "bodies: {s: {type: beam, start: [0, 0], end: [1, 0], elements: 2, section: {points: %s}, material: {E: 1e9, density: 1}}}"
    for points, expected in (
        (L, "bodies.s.section: found principal axes at "),
        (U, "bodies.s.section: found a shear centre 0.0"),
        ([[0, 0], [1, 1], [1, 0], [0, 1]], "bodies.s.section: found outlines that cross"),
        ([[0, 0], [1, 1]], "bodies.s.section.points: found 2 values, expected 3"),
    ):
        with pytest.raises(InputError, match=expected):
            read_scene(beam % points)
    assert math.isfinite(read_scene(beam % scaled(SQUARE, 0.01)).bodies["s.start"].mass)


@pytest.mark.long
@pytest.mark.parametrize(("taper", "symmetric"), [(0.008, True), (0.016, False)])
def test_a_shear_centre_nearly_at_the_centroid_is_there(taper, symmetric):
    """That of a nearly square trapezium is 0.088 times the taper from the centroid, in units of the root of the area."""
    pytest.importorskip("sectionproperties")
    trapezium = ((-1 - taper, -1), (1 + taper, -1), (1 - taper, 1), (-1 + taper, 1))
    y, z = Drawn(points=scaled(trapezium, 0.01)).properties(0.3).shear_centre
    assert y == 0.0
    assert pytest.approx(0.0 if symmetric else 0.0884 * taper * 0.02, rel=1e-2) == z
