"""CVCV: two curves that touch, against closed forms of cams and their followers."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs import InputError
from stiffmbs.adams.load import read_adams

pytestmark = pytest.mark.long  # kernels that no other test compiles, or many scenes

HEAD = """cam and follower
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=MILLIMETER, TIME=SECOND
PART/1, GROUND
MARKER/11, PART=1
MARKER/12, PART=1, REULER=180D,90D,0
PART/2, QG={center}, MASS=2, CM=21, IP=900,900,1800{spin}
MARKER/21, PART=2
MARKER/22, PART=2, QP={back}
MARKER/23, PART=2, FLOATING
PART/3, QG={follower}, MASS=0.5, CM=31, IP=1,1,1
MARKER/31, PART=3, REULER=180D,90D,0
MARKER/32, PART=3
MARKER/33, PART=3, FLOATING
JOINT/1, REVOLUTE, I=22, J=11
JOINT/2, TRANSLATIONAL, I=31, J=12
CURVE/1, CLOSED, CURVE_POINTS, ORDER=4, MATRIX=1
MATRIX/1, FULL=RORDER, M={m}, N=3, VALUES={cam}
CURVE/2, {sort}, CURVE_POINTS, ORDER=4, MATRIX=2
MATRIX/2, FULL=RORDER, M={n}, N=3, VALUES={face}
CVCV/6, ICURVE=2, JCURVE=1, IFLOAT=33, JFLOAT=23, IRM=32, JRM=21
REQUEST/1, F2=CVCV(6, 0, 3, 0)\\, F3=CVCV(6, 1, 3, 0)
REQUEST/2, FORCE, I=33, J=23
ACCGRAV/JGRAV=-9806.65
END
"""
G = 9.80665
FACE = np.column_stack([np.linspace(-80, 80, 5), np.zeros(5), np.zeros(5)])


def ellipse(a, b, count=25):
    angles = np.linspace(0, 2 * np.pi, count)
    return np.column_stack([a * np.cos(angles), b * np.sin(angles), 0 * angles])


def listed(points):
    return "\n, ".join(", ".join(repr(float(x)) for x in row) for row in points)


def dataset(cam, face, center, follower, sort="OPEN", spin=0.0):
    """A cam whose hinge is at the origin, and a follower that goes along y."""
    x, y = center
    moving = f"\n, VX={-spin * y}, VY={spin * x}, WZ={spin}" if spin else ""
    return HEAD.format(
        center=f"{x},{y},0", back=f"{-x},{-y},0", follower=f"0,{follower},0", m=len(cam), n=len(face), cam=listed(cam),
        face=listed(face), sort=sort, spin=moving,
    )  # fmt: skip


def turning(height, angle, spin, times, inertia, weight):
    """The cam's angle by the energy of cam and follower: (J + m h'^2) w' + m h' h'' w^2 + weight' + m g h' = 0."""
    eps = 1e-4

    def rates(t, y):
        up, down, mid = height(y[0] + eps), height(y[0] - eps), height(y[0])
        slope, bend = (up - down) / (2 * eps), (up - 2 * mid + down) / eps**2
        return [y[1], -(0.5 * slope * bend * y[1] ** 2 + 0.5 * G * slope + weight(y[0])) / (inertia + 0.5 * slope**2)]

    return solve_ivp(rates, (times[0], times[-1]), [angle, spin], t_eval=times, rtol=1e-10, atol=1e-12).y


def test_an_eccentric_disc_lifts_a_flat_face():
    """The face is at e sin(angle) + R; the force on it by its acceleration, and no torque about the point of contact."""
    found = stiffmbs.run(
        read_adams(dataset(ellipse(40, 40), FACE, (15, 0), 40, spin=8.0)), duration=0.8, points=17, rtol=1e-9
    )
    e = 0.015
    angle, rate = turning(
        lambda a: e * np.sin(a) + 0.04, 0.0, 8.0, found.time, 1.8e-3 + 2 * e**2, lambda a: 2 * G * e * np.cos(a)
    )
    np.testing.assert_allclose(found["PART_3.y"], e * np.sin(angle) + 0.04, atol=2e-6)
    np.testing.assert_allclose(found["PART_2.wz"], rate, atol=2e-4)
    np.testing.assert_allclose(found["CVCV_6_touch.x"], e * np.cos(angle), atol=2e-6)
    np.testing.assert_allclose(found["CVCV_6.fy"], 0.5 * (found["PART_3.ay"] + G), atol=1e-5)
    np.testing.assert_allclose(found["CVCV_6.tz"], 0, atol=1e-5)
    for name, sign in (("REQUEST_1.f2", 1), ("REQUEST_1.f3", -1), ("REQUEST_2.fy", 1)):
        np.testing.assert_allclose(found[name], sign * found["CVCV_6.fy"], atol=1e-9)


def test_an_ellipse_lifts_a_flat_face_by_its_support():
    """Height sqrt(a^2 sin^2 + b^2 cos^2) of the highest point of an ellipse that turns about its middle."""
    cam = ellipse(50, 30, 73)
    found = stiffmbs.run(read_adams(dataset(cam, FACE, (0, 0), 30, spin=10.0)), duration=0.8, points=17, rtol=1e-9)

    def height(a):
        return np.hypot(0.05 * np.sin(a), 0.03 * np.cos(a))

    angle, rate = turning(height, 0.0, 10.0, found.time, 1.8e-3, lambda a: 0.0)
    np.testing.assert_allclose(found["PART_3.y"], height(angle), atol=2e-5)
    np.testing.assert_allclose(found["PART_2.wz"], rate, atol=5e-3)


def test_an_eccentric_disc_lifts_a_roller():
    """Two circles are as far apart as the sum of their radii, though they are drawn 1 mm apart."""
    text = dataset(ellipse(40, 40), ellipse(10, 10), (15, 0), np.sqrt(50**2 - 15**2) + 1, "CLOSED", spin=8.0)
    found = stiffmbs.run(read_adams(text), duration=0.8, points=17, rtol=1e-9)
    gap = np.hypot(found["PART_3.x"] - found["PART_2.x"], found["PART_3.y"] - found["PART_2.y"])
    np.testing.assert_allclose(gap, 0.05, atol=1e-8)
    np.testing.assert_allclose(found["energy.total"], found["energy.total"][0], atol=1e-6)
    assert np.ptp(found["PART_3.y"]) > 0.01


def test_a_follower_flies_when_its_curves_no_longer_touch(tmp_path):
    (tmp_path / "cam.adm").write_text(
        dataset(ellipse(40, 40), FACE, (15, 0), 40, spin=8.0).replace("REQUEST", "!REQUEST")
    )
    commands = "SIM/DYN, END=0.1, STEPS=5\nDEACTIVATE/CVCV, ID=6\nSIM/DYN, END=0.2, STEPS=5\n"
    (tmp_path / "cam.acf").write_text(commands)
    found = stiffmbs.run(tmp_path / "cam.adm", rtol=1e-9)
    t, y, v = found.time[6:] - 0.1, found["PART_3.y"][6:], found["PART_3.vy"][6:]
    np.testing.assert_allclose(y, y[0] + v[0] * t - G * t**2 / 2, atol=1e-8)
    (tmp_path / "cam.acf").write_text(commands + "ACTIVATE/CVCV, ID=6\nSIM/DYN, END=0.3, STEPS=5\n")
    with pytest.raises(InputError, match="found CVCV/6, CVCV, activated or changed between simulations"):
        stiffmbs.load_scene(tmp_path / "cam.adm")


def test_curves_that_are_drawn_further_apart_than_the_smaller_one_is_wide_do_not_touch():
    for follower, across in ((120, 0), (50, 30)):
        roller = np.add(ellipse(10, 10), (0, 0, across))
        with pytest.raises(InputError, match=r"CVCV/6: found curves that do not touch \(gap of 0\.0"):
            read_adams(dataset(ellipse(40, 40), roller, (0, 0), follower, "CLOSED"))


def test_a_pair_without_a_curve_or_with_a_stated_velocity_is_refused():
    text = dataset(ellipse(40, 40), FACE, (15, 0), 40)
    with pytest.raises(InputError, match="CVCV/6: found CURVE = 5, expected the number of a CURVE"):
        read_adams(text.replace("ICURVE=2", "ICURVE=5"))
    with pytest.raises(InputError, match="CVCV/6: found no JRM, expected"):
        read_adams(text.replace(", JRM=21", ""))
    with pytest.raises(InputError, match="CVCV/6: found IVELOCITY, expected the velocities of the parts"):
        read_adams(text.replace(", JRM=21", ", JRM=21, IVEL=3"))


def test_the_drawn_start_is_found_between_curves_that_cross():
    text = dataset(ellipse(40, 40), FACE, (15, 0), 38)
    scene = read_adams(text)
    np.testing.assert_allclose(scene.bodies["CVCV_6_touch"].position, [0.015, 0.039, 0], atol=1e-9)
    below = read_adams(text.replace("JRM=21", "JRM=21, JDISP=0,-40,0"))
    np.testing.assert_allclose(below.bodies["CVCV_6_touch"].position, [0.015, -0.001, 0], atol=1e-9)
