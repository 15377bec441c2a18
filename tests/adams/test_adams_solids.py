"""CONTACT of cylinders, boxes and ellipsoids: where their middles are, sizes and laws in SI, in either order."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs.adams.load import read_adams
from stiffmbs.errors import InputError

from .adams_parts import made

GRAPHICS = """GRAPHICS/1, PLANE, RM=1, XMIN=-1, XMAX=1, YMIN=-1, YMAX=1
GRAPHICS/2, ELLIPSOID, CM=31, XSCALE=400, YSCALE=200, ZSCALE=100
GRAPHICS/3, CYLINDER, CM=22, LENGTH=300, SIDES=20, RADIUS=40, SEG=20
GRAPHICS/4, BOX, CORNER=33, X=100, Y=-60, Z=40
GRAPHICS/5, ELLIPSOID, CM=31, XSCALE=80, YSCALE=80, ZSCALE=80
GRAPHICS/6, CYLINDER, CM=2, LENGTH=-300, RADIUS=40
"""
LAW = "IMPACT, STIFFNESS=1E5, DAMPING=10, EXPONENT=2.2, DMAX=0.1"
RUBBING = f"{LAW}, COULOMB_FRICTION=ON, MU_STATIC=0.3, MU_DYNAMIC=0.1, STICTION_TRANS=100, FRICTION_TRANS=1000"


def contact(i, j, law=LAW):
    return made(f"{GRAPHICS}CONTACT/1, IGEOM={i}, JGEOM={j}, {law}", "MILLIMETER")


@pytest.mark.parametrize(
    ("i", "j", "kind", "sizes"),
    [
        (1, 2, "ellipsoid_plane_impact", {"x": 0.2, "y": 0.1, "z": 0.05}),
        (3, 1, "cylinder_plane_impact", {"radius": 0.04, "length": 0.3}),
        (1, 4, "box_plane_impact", {"x": 0.1, "y": 0.06, "z": 0.04}),
        (4, 5, "sphere_box_impact", {"radius": 0.04, "x": 0.1, "y": 0.06, "z": 0.04}),
        (5, 6, "sphere_cylinder_impact", {"radius": 0.04, "cylinder_radius": 0.04, "cylinder_length": 0.3}),
    ],
)
def test_pairs_of_solids(i, j, kind, sizes):
    force = contact(i, j)["forces"]["CONTACT_1"]
    assert force["type"] == kind
    assert {name: force[name] for name in sizes} == pytest.approx(sizes)
    assert force["stiffness"] == pytest.approx(1e5 * 1e3**2.2) and force["exponent"] == 2.2
    assert (force["damping"], force["depth"]) == pytest.approx((1e4, 1e-4)) and "friction" not in force


@pytest.mark.parametrize(
    ("i", "j", "shapes", "sizes"),
    [
        (5, 2, ("ellipsoid", "ellipsoid"), ([0.08, 0.08, 0.08], [0.4, 0.2, 0.1])),
        (4, 3, ("box", "cylinder"), ([0.1, 0.06, 0.04], [0.08, 0.08, 0.3])),
        (6, 4, ("cylinder", "box"), ([0.08, 0.08, 0.3], [0.1, 0.06, 0.04])),
        (2, 6, ("ellipsoid", "cylinder"), ([0.4, 0.2, 0.1], [0.08, 0.08, 0.3])),
    ],
)
def test_two_solids_with_whole_sizes(i, j, shapes, sizes):
    force = contact(i, j)["forces"]["CONTACT_1"]
    assert force["type"] == "solid_impact" and (force["i_shape"], force["j_shape"]) == shapes
    assert (force["i_size"], force["j_size"]) == tuple(pytest.approx(size) for size in sizes)


def test_friction_has_its_velocities_in_si():
    force = contact(1, 3, RUBBING)["forces"]["CONTACT_1"]
    names = ("static_friction", "friction", "stiction_velocity", "friction_velocity")
    assert [force[name] for name in names] == pytest.approx([0.3, 0.1, 0.1, 1])


def test_middles_of_boxes_and_cylinders():
    """A box stands at its corner with signed sides, a cylinder begins at its marker and goes along z, which is along -x there."""
    found = contact(4, 1)
    part, _, name = found["forces"]["CONTACT_1"]["i"].partition(".")
    corner = np.array(found["bodies"][part]["markers"]["MARKER_33"]["point"])
    np.testing.assert_allclose(
        found["bodies"][part]["markers"][name]["point"] - corner, [0.05, -0.03, 0.02], atol=1e-12
    )
    found = contact(5, 6)
    name = found["forces"]["CONTACT_1"]["j"].partition(".")[2]
    np.testing.assert_allclose(
        found["markers"][name]["point"], [0, 0.15, 0.001], atol=1e-12
    )  # z of marker 2 is along -y


def test_pairs_that_are_not_solved_are_refused():
    with pytest.raises(
        InputError,
        match=r"CONTACT/1: found PLANE and PLANE, expected SPHERE and PLANE, .*, or two of SPHERE, ELLIPSOID",
    ):
        contact(1, 1)
    with pytest.raises(InputError, match="found no RADIUS, expected a number above zero"):
        made("GRAPHICS/1, PLANE, RM=1\nGRAPHICS/3, CYLINDER, CM=22, LENGTH=300\nCONTACT/1, IGEOM=3, JGEOM=1, " + LAW)


@pytest.mark.long
def test_the_force_of_a_contact_is_that_on_the_side_of_igeom():
    """A ball at rest on a plane, asked for as IGEOM and as JGEOM, on either side."""
    text = """ball
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=MILLIMETER, TIME=SECOND
PART/1, GROUND
MARKER/1, PART=1
PART/2, QG=0,0,40, MASS=2, CM=21, IP=1,1,1
MARKER/21, PART=2
GRAPHICS/1, PLANE, RM=1, XMIN=-1, XMAX=1, YMIN=-1, YMAX=1
GRAPHICS/2, ELLIPSOID, CM=21, XSCALE=80, YSCALE=80, ZSCALE=80
CONTACT/1, IGEOM={i}, JGEOM={j}, IMPACT, STIFFNESS=1E4, DAMPING=10, EXPONENT=1.5, DMAX=0.1
REQUEST/1, F2=CONTACT(1,0,4,0)\\, F3=CONTACT(1,1,4,0)\\, F4=CONTACT(1,0,1,0)
ACCGRAV/KGRAV=-9806.65
LIST
END
"""
    for i, j, sign in ((2, 1, 1), (1, 2, -1)):
        found = stiffmbs.run(read_adams(text.format(i=i, j=j)), duration=0.2, points=3)
        force = [found[f"REQUEST_1.f{k}"][-1] for k in (2, 3, 4)]
        np.testing.assert_allclose(force, np.array([sign, -sign, 1]) * 2 * 9.80665, rtol=1e-3)
    notes = read_adams(text.format(i=1, j=2).replace("(1,0,1,0)", "(1,0,5,0)")).notes
    assert any("found the torque of CONTACT/1, expected a component of its force" in note for note in notes)


BALLS = """two balls
PART/1, GROUND
PART/2, MASS=2, CM=21, IP=0.01,0.01,0.01, VX=3, WZ=20
MARKER/21, PART=2
PART/3, QG=0.5,0.1,0, MASS=1, CM=31, IP=0.002,0.002,0.002
MARKER/31, PART=3
GRAPHICS/1, ELLIPSOID, CM=21, XSCALE=0.3, YSCALE=0.3, ZSCALE=0.3
GRAPHICS/2, ELLIPSOID, CM=31, XSCALE=0.2, YSCALE=0.2, ZSCALE=0.2
CONTACT/1, IGEOM=1, JGEOM=2, IMPACT, STIFFNESS=1E5, DAMPING=50, EXPONENT=1.5, DMAX=1E-3, COULOMB_FRICTION=ON
, MU_STATIC=0.3, MU_DYNAMIC=0.2, STICTION_TRANSITION_VELOCITY=0.1, FRICTION_TRANSITION_VELOCITY=0.5
END
"""


def step(x, x0, h0, x1, h1):
    z = min(max((x - x0) / (x1 - x0), 0), 1)
    return h0 + (h1 - h0) * z * z * (3 - 2 * z)


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


@pytest.mark.long
def test_two_balls_rub_as_they_collide():
    """Against the same law in the plane of the collision, integrated by itself."""
    found = stiffmbs.run(read_adams(BALLS), duration=0.2, points=11, rtol=1e-9)

    def rates(t, y):
        a, b, va, vb, wa, wb = y[0:2], y[2:4], y[4:6], y[6:8], y[8], y[9]
        way = a - b
        distance = np.hypot(*way)
        n = way / distance
        gap, rate = distance - 0.25, (va - vb) @ n
        force, moment_a, moment_b = np.zeros(2), 0.0, 0.0
        if gap < 0:
            pressure = max(1e5 * (-gap) ** 1.5 - 50 * rate * step(gap, -1e-3, 1, 0, 0), 0)
            point = a - 0.15 * n
            across = np.array([-n[1], n[0]])
            slide = (
                (va - vb) @ across + wa * -0.15 * (n[0] * across[1] - n[1] * across[0]) - wb * cross(point - b, across)
            )
            mu = (
                step(slide, -0.1, -0.3, 0.1, 0.3)
                if abs(slide) < 0.1
                else np.sign(slide) * step(abs(slide), 0.1, 0.3, 0.5, 0.2)
            )
            force = pressure * n - mu * pressure * across
            moment_a, moment_b = cross(point - a, force), -cross(point - b, force)
        return [*va, *vb, *(force / 2), *(-force / 1), moment_a / 0.01, moment_b / 0.002]

    own = solve_ivp(rates, (0, 0.2), [0, 0, 0.5, 0.1, 3, 0, 0, 0, 20, 0], rtol=1e-10, atol=1e-12, max_step=1e-5).y[
        :, -1
    ]
    names = [
        "PART_2.x",
        "PART_2.y",
        "PART_3.x",
        "PART_3.y",
        "PART_2.vx",
        "PART_2.vy",
        "PART_3.vx",
        "PART_3.vy",
        "PART_2.wz",
        "PART_3.wz",
    ]
    np.testing.assert_allclose([found[name][-1] for name in names], own, atol=2e-5)
    assert abs(own[9]) > 1


def test_a_solid_of_a_contact_is_read_and_any_other_graphics_are_left_out(tmp_path):
    path = tmp_path / "ball.adm"
    path.write_text(BALLS.replace("END", "GRAPHICS/3, CYLINDER, CM=21, LENGTH=0.1, RADIUS=0.1\nEND"))
    found = {entry.statement: entry.fate for entry in stiffmbs.listed_statements(path)}
    assert [found[f"GRAPHICS/{k}"] for k in (1, 2, 3)] == ["read", "read", "left out"]
    assert "GRAPHICS (line 11) is left out: graphics" in stiffmbs.load_scene(path).notes
