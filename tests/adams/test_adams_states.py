"""Statements with states of their own, angles between markers, and contacts, against equations of their own."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import stiffmbs
from stiffmbs.adams.load import read_adams

from ..minimal_coordinates import turned

UNITS = "states\nUNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=MILLIMETER, TIME=MILLISECOND\nPART/1, GROUND\n"
SLIDER = """MARKER/10, PART=1, REULER=90D,90D,0
PART/2, MASS=2, CM=21, IP=1e5,2e5,2e5, VX=0.5
MARKER/21, PART=2, REULER=90D,90D,0
JOINT/1, TRANSLATIONAL, I=21, J=10
"""


def run(text, **settings):
    return stiffmbs.run(read_adams(UNITS + text + "END\n"), **{"rtol": 1e-9, "duration": 0.3, "points": 4, **settings})


@pytest.mark.long
def test_a_transfer_function_and_a_linear_system_and_an_equation_drive_a_slider():
    found = run(
        SLIDER
        + """VARIABLE/1, FUNCTION=DZ(21,10,10)-20
ARRAY/1, X
ARRAY/2, U, VARIABLES=1
ARRAY/3, Y
TFSISO/7, X=1, U=2, Y=3, NUMERATOR=2, 5, DENOMINATOR=1, 20, 300
ARRAY/4, X
ARRAY/5, Y
ARRAY/6, IC, NUMBERS=1,2
MATRIX/1, FULL=RORDER, M=2, N=2, VALUES=0,1,-0.01,-0.1
MATRIX/2, FULL=CORDER, M=2, N=1, VALUES=0,0.1
MATRIX/3, SPARSE, I=1,1, J=1,2, VALUES=3,4
LSE/1, X=4, U=2, Y=5, A=1, B=2, C=3, IC=6
DIFF/1, IC=2.5, FUNCTION=-0.01*DIF(1)+0.001*ARYVAL(5,1)
SFORCE/1, TRANSLATIONAL, ACTIONONLY, I=21, J=10, FUNCTION=-0.3*ARYVAL(3,1)-DIF(1)
REQUEST/1, F2=DIF(1)\\, F3=DIF1(1)\\, F4=ARYVAL(3,1)\\, F5=ARYVAL(5,1)\\, F6=ARYVAL(4,2)\\
"""
    )

    def rates(t, y):  # mm, ms, N: a force of 1 N gives 2 kg 5e-4 mm/ms^2
        x, v, z1, z2, l1, l2, d = y
        u = x - 20
        output, flow = 2 * z1 + 5 * z2, 3 * l1 + 4 * l2
        force = -0.3 * output - d
        return [
            v,
            force / 2 * 1e-3,
            z2,
            (u - z1 - 20 * z2) / 300,
            l2,
            -0.01 * l1 - 0.1 * l2 + 0.1 * u,
            -0.01 * d + 0.001 * flow,
        ]

    start = [0, 0.5, 0, 0, 1, 2, 2.5]
    own = solve_ivp(rates, (0, 300), start, t_eval=np.linspace(0, 300, 4), rtol=1e-11, atol=1e-11).y
    np.testing.assert_allclose(found["PART_2.x"] * 1000, own[0], rtol=1e-6, atol=1e-6)
    expected = {"f2": own[6], "f3": -0.01 * own[6] + 0.001 * (3 * own[4] + 4 * own[5]), "f4": 2 * own[2] + 5 * own[3],
                "f5": 3 * own[4] + 4 * own[5], "f6": own[5]}  # fmt: skip
    for name, values in expected.items():
        np.testing.assert_allclose(found[f"REQUEST_1.{name}"], values, rtol=1e-6, atol=1e-6, err_msg=name)


def test_an_implicit_equation_gives_the_rate_of_its_state():
    """0 = r + 0.1 r^3 + 0.05 x - 0.002 v, per ms, and a force by x and by r."""
    found = run(
        SLIDER
        + """DIFF/1, IC=2.5,-0.1, IMPLICIT, FUNCTION=DIF1(1)+0.1*DIF1(1)**3+0.05*DIF(1)-0.002*VZ(21,10,10)
SFORCE/1, TRANSLATIONAL, ACTIONONLY, I=21, J=10, FUNCTION=-DIF(1)+3*DIF1(1)
REQUEST/1, F2=DIF(1)\\, F3=DIF1(1)\\
"""
    )

    def rate(x, v):
        return brentq(lambda r: r + 0.1 * r**3 + 0.05 * x - 0.002 * v, -10, 10, xtol=1e-14)

    def rates(t, y):  # mm, ms, N
        _, v, x = y
        r = rate(x, v)
        return [v, (3 * r - x) / 2 * 1e-3, r]

    own = solve_ivp(rates, (0, 300), [0, 0.5, 2.5], t_eval=np.linspace(0, 300, 4), rtol=1e-11, atol=1e-11).y
    np.testing.assert_allclose(found["PART_2.x"] * 1000, own[0], rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(found["REQUEST_1.f2"], own[2], rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(found["REQUEST_1.f3"], [rate(x, v) for _, v, x in own.T], rtol=1e-6, atol=1e-6)


def test_angles_are_those_of_three_turns():
    """A body turned about z, y and x in its own axes; about z, x and z; and the angle at a corner."""
    yaw, pitch, roll = 0.4, -0.7, 1.1
    turn = turned((0, 0, 1), yaw) @ turned((0, 1, 0), -pitch) @ turned((1, 0, 0), roll)
    theta = np.arccos(turn[2, 2])
    psi, phi = np.arctan2(turn[0, 2], -turn[1, 2]), np.arctan2(turn[2, 0], turn[2, 1])
    euler = ",".join(f"{np.degrees(a):.12f}D" for a in (psi, theta, phi))
    found = run(
        f"MARKER/10, PART=1\nMARKER/11, PART=1, QP=3,0,0\nPART/2, MASS=1, CM=21, IP=1,1,1, REULER={euler}\nMARKER/21, PART=2\n"
        "MARKER/22, PART=2, QP=0,0,4\n"
        "SFORCE/1, ROTATIONAL, ACTIONONLY, I=21, J=10, FUNCTION=PSI(21,10)+2*THETA(21,10)+4*PHI(21,10)+8*YAW(21,10)\n"
        "REQUEST/1, F2=YAW(21,10)\\, F3=PITCH(21,10)\\, F4=ROLL(21)\\, F5=INCANG(11,10,22)\\\n",
        duration=1e-9,
        points=2,
    )
    for name, value in (("f2", yaw), ("f3", pitch), ("f4", roll), ("f5", np.arccos(turn[0, 2]))):
        assert found[f"REQUEST_1.{name}"][0] == pytest.approx(value), name
    assert found["SFORCE_1.tz"][0] == pytest.approx((psi + 2 * theta + 4 * phi + 8 * yaw) * 1e-3)


BALLS = """UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
MARKER/10, PART=1, REULER=0,90D,0
PART/2, QG=0,-0.0999,0, MASS=1, CM=21, IP=0.004,0.004,0.004, VX=1
MARKER/21, PART=2
PART/3, QG=0.3,-0.0999,0, MASS=2, CM=31, IP=0.008,0.008,0.008
MARKER/31, PART=3
GRAPHICS/1, PLANE, RM=10, XMIN=-1, XMAX=1, YMIN=-1, YMAX=1
GRAPHICS/2
, ELLIPSOID
, CM=21
, XSCALE=0.2, YSCALE=0.2, ZSCALE=0.2
GRAPHICS/3, ELLIPSOID, CM=31, XSC=0.2, YSC=0.2, ZSC=0.2
"""


def balls(contacts, **settings):
    text = f"balls\nPART/1, GROUND\n{BALLS}{contacts}ACCGRAV/JGRAV=9.81\nEND\n"
    return stiffmbs.run(read_adams(text), rtol=1e-9, **settings)


@pytest.mark.long
def test_spheres_collide_without_loss():
    law = "IMPACT, STIFFNESS=1e5, EXPONENT=1.5, DMAX=0.0001\n"
    plane = "CONTACT/1, IGEOM=2, JGEOM=1, " + law + "CONTACT/2, IGEOM=1, JGEOM=3, " + law
    found = balls(plane + "CONTACT/3, IGEOM=3, JGEOM=2, " + law, duration=0.3, points=61)
    np.testing.assert_allclose([found["PART_2.vx"][-1], found["PART_3.vx"][-1]], [-1 / 3, 2 / 3], rtol=5e-3)
    assert found["CONTACT_1.fy"][:30].max() < 0  # the plane's z axis, out of the solid, is along -y
    sunk = (9.81 / 1e5) ** (2 / 3)
    assert found["PART_2.y"].mean() == pytest.approx(-0.1 + sunk, abs=0.7 * sunk)


@pytest.mark.long
def test_a_sliding_sphere_comes_to_roll_at_five_sevenths():
    law = "IMPACT, STIFFNESS=1e5, DAMPING=500, EXPONENT=1.5, DMAX=0.0001, COULOMB_FRICTION=ON, MU_STATIC=0.3, MU_DYNAMIC=0.2, "
    found = balls(
        "CONTACT/1, IGEOM=1, JGEOM=2, " + law + "STICTION_TRANS=0.001, FRICTION_TRANS=0.002\n", duration=0.25, points=26
    )
    t = found.time
    sliding = t < 0.12  # 2/7 v/(mu g) = 0.146 s
    np.testing.assert_allclose(found["PART_2.vx"][sliding], 1 - 0.2 * 9.81 * t[sliding], atol=0.01)
    assert found["PART_2.vx"][-1] == pytest.approx(5 / 7, rel=0.02)
    assert abs(found["PART_2.wz"][-1]) * 0.1 == pytest.approx(found["PART_2.vx"][-1], rel=0.02)


@pytest.mark.parametrize(
    "text, words",
    [
        ("GRAPHICS/5, TORUS, CM=21\nCONTACT/1, IGEOM=5, JGEOM=1, ", "found TORUS in a CONTACT"),
        ("GRAPHICS/5, BOX, CORNER=21, X=1, Y=1\nCONTACT/1, IGEOM=5, JGEOM=1, ", "found no Z, expected"),
        ("CONTACT/1, IGEOM=1, JGEOM=1, ", "found PLANE and PLANE, expected SPHERE and PLANE"),
        ("CONTACT/1, IGEOM=9, JGEOM=1, ", "found the geometry 9"),
        ("CONTACT/1, POISSON, IGEOM=2, JGEOM=1, ", "found POISSON, expected a contact by IMPACT"),
    ],
)
def test_contacts_that_are_not_read_are_refused(text, words):
    with pytest.raises(stiffmbs.InputError, match=words):
        balls(text + "IMPACT, STIFFNESS=1e5, EXPONENT=1.5, DMAX=0.0001\n")


@pytest.mark.parametrize(
    "text, words",
    [
        ("ARRAY/1, X\nARRAY/2, U\nARRAY/3, Y\nTFSISO/1, X=1, U=2, Y=3, NUM=1, DENOM=1,1", "found U = 2, expected the number of an ARRAY"),
        ("TFSISO/1, X=1, U=2, Y=3, NUM=1,1,1, DENOM=1,1", "found no proper transfer function"),
        ("ARRAY/1, X\nMATRIX/1, FULL=RORDER, M=1, N=2, VALUES=1,2\nLSE/1, X=1, A=1", "found A of 1 by 2 numbers, expected 1 rows and 1 col"),
        ("MATRIX/1, FULL=RORDER, M=2, N=2, VALUES=1,2", "found 2 VALUES, M = 2 and N = 2"),
        ("MATRIX/1, FILE=a.txt", "found FILE, expected the numbers"),
        ("SFORCE/1, TRANSLATIONAL, ACTIONONLY, I=21, J=10, FUNCTION=ARYVAL(8,1)", r"found ARYVAL\(8, 1\), expected an ARRAY"),
        ("ARRAY/8, IC, NUM=1,2\nSFORCE/1, TRANSLATIONAL, ACTIONONLY, I=21, J=10, FUNCTION=ARYVAL(8,3)", r"found ARYVAL\(8, 3\), expected"),
    ],
)  # fmt: skip
def test_systems_that_make_no_sense_are_refused(text, words):
    with pytest.raises(stiffmbs.InputError, match=words):
        run(SLIDER + text + "\n", duration=0.01)


@pytest.mark.long
def test_a_field_without_symmetry_is_followed():
    """Force and torque by full matrices, of which none is symmetric; against the linear equations of small displacements."""
    rng = np.random.default_rng(3)
    K, C = (np.diag([4, 5, 6, 4, 5, 6.0]) * size + rng.uniform(-1, 1, (6, 6)) for size in (1, 0.1))
    columns = [", ".join(f"{x!r}" for x in M.T.ravel().tolist()) for M in (K, C)]
    inertia = np.diag([2, 2, 2, 1, 1.5, 2])
    text = (
        "field\nUNITS/SYSTEM=MKS\nPART/1, GROUND\nMARKER/10, PART=1\nPART/2, MASS=2, CM=21, IP=1,1.5,2, VX=1E-5, WY=1E-5\n"
        f"MARKER/21, PART=2\nFIELD/1, I=21, J=10, KMATRIX={columns[0]}\n, CMATRIX={columns[1]}\n, FORCE=1E-5,0,0,0,0,0\nEND\n"
    )
    found = stiffmbs.run(read_adams(text), rtol=1e-10, atol=1e-14, duration=2, points=5)
    push = np.array([1e-5, 0, 0, 0, 0, 0])
    own = solve_ivp(
        lambda t, y: [*y[6:], *np.linalg.solve(inertia, push - K @ y[:6] - C @ y[6:])],
        (0, 2), [*np.zeros(6), 1e-5, 0, 0, 0, 1e-5, 0], t_eval=found.time, rtol=1e-11, atol=1e-16,
    ).y  # fmt: skip
    for k, name in enumerate(("x", "y", "z")):
        np.testing.assert_allclose(found[f"PART_2.{name}"], own[k], atol=1e-9)
        np.testing.assert_allclose(found[f"PART_2.w{name}"], own[9 + k], atol=1e-9)


@pytest.mark.long
def test_the_torque_of_a_field_without_symmetry_on_marker_j_is_about_that_marker():
    """FIELD(id, 1, TX ..): -T - d x F, with d from J to I, also where J is off the origin of its part."""
    stiffness = np.diag([4, 5, 6, 4, 5, 6.0])
    stiffness[0, 4] = 1.0
    text = (
        "field\nUNITS/SYSTEM=MKS\nPART/1, GROUND\nMARKER/10, PART=1, QP=3,2,1\nPART/2, MASS=2, CM=21, IP=1,1.5,2\n"
        f"MARKER/21, PART=2\nFIELD/1, I=21, J=10, KMATRIX={', '.join(map(repr, stiffness.T.ravel().tolist()))}\n"
        ", FORCE=0,0,0,1,2,3\n"
        + "".join(f"VARIABLE/{k}, FUNCTION=FIELD(1,{k // 6},{(2, 3, 4, 6, 7, 8)[k % 6]},0)\n" for k in range(12))
        + "VARIABLE/12, FUNCTION=FIELD(1,1,5,0)\n"
        + "END\n"
    )
    found = stiffmbs.run(read_adams(text), duration=1e-6, points=2)
    (force, torque), (force_on_j, torque_on_j) = np.reshape(
        [found[f"VARIABLE_{k}"][0] for k in range(12)], (2, 2, 3)
    )  # fmt: skip
    np.testing.assert_allclose(force, [12, 10, 6], atol=1e-12)
    np.testing.assert_allclose(force_on_j, -force, atol=1e-12)
    np.testing.assert_allclose(torque_on_j, -torque - np.cross([-3, -2, -1], force), atol=1e-12)
    np.testing.assert_allclose(found["VARIABLE_12"][0], np.linalg.norm(torque_on_j), atol=1e-12)


def test_all_faults_of_a_dataset_are_told_at_once():
    text = (
        SLIDER
        + "JOINT/2, REVOLUTE, I=77, J=10\nSFORCE/1, TRANSL, I=21, J=10, FUNCTION=DX(88)\nMOTION/1, JOINT=9, FUNC=1\n"
    )
    with pytest.raises(stiffmbs.InputError, match=r"I = 77.*JOINT = 9.*the marker 88"):
        run(text)
    with pytest.raises(
        stiffmbs.InputError,
        match=r"found unsupported statements: FLEX_BODY/1.*JOINT/2: found no J.*SFORCE/1: found no kind",
    ):
        run(SLIDER + "FLEX_BODY/1\nJOINT/2, REVOLUTE, I=21\nSFORCE/1, I=21, J=10, FUNCTION=1\n")


def test_a_variable_of_a_rate_that_depends_on_it_is_solved():
    """V = D'/2 + 1 and D' = V - D, so that V = 2 - D and D' = 2 - 2 D: each was substituted into the other without end."""
    text = "DIFF/1, IC=0, FUNCTION=VARVAL(1)-DIF(1)\nVARIABLE/1, FUNCTION=0.5*DIF1(1)+1\nREQUEST/1, F2=VARVAL(1)\\F3=DIF1(1)\n"
    found = run(SLIDER + text, duration=1e-3)
    state = 1 - np.exp(-2e3 * found.time)
    np.testing.assert_allclose(found["REQUEST_1.f2"], 2 - state, atol=1e-6)
    np.testing.assert_allclose(found["REQUEST_1.f3"], 2 - 2 * state, atol=1e-6)


@pytest.mark.parametrize(
    "text", ["DIFF/1, IC=0, FUNCTION=DIF1(1)/2\n", "DIFF/1, IC=0, FUNCTION=DIF1(2)\nDIFF/2, IC=0, FUNCTION=DIF1(1)\n"]
)
def test_a_rate_that_contains_itself_is_refused(text):
    with pytest.raises(
        stiffmbs.InputError, match=r"DIFF/1: found DIF1\(\d\) in the rate of DIFF/\d, expected IMPLICIT"
    ):
        read_adams(UNITS + SLIDER + text + "END\n")
