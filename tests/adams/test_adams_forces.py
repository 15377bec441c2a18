"""Runs of Adams datasets against closed forms: every statement that pushes something."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs.adams.load import read_adams

from .metric_datasets import GRAVITY, HEAD, TWO, G, run


@pytest.mark.long
def test_action_and_reaction_between_two_parts():
    """Whatever a GFORCE, an SFORCE, a bushing and a field do between two free parts, their momenta are kept."""
    text = (
        TWO.replace("QG=1,0,0", "QG=1,0.2,0.1, REULER=20D,30D,0, WX=1, WY=2, WZ=3")
        + r"""
MARKER/39, PART=3, FLOATING
GFORCE/1, I=21, JFLOAT=39, RM=30, FX=SIN(3*TIME)\ FY=2\ FZ=DX(21,31)\ TX=1\ TY=TIME\ TZ=WZ(21,31,31)
SFORCE/1, TRANS, I=21, J=31, FUNC=-20*(DM(21,31)-0.7) - 3*VR(21,31)
BUSHING/1, I=21, J=31, K=10,20,30, KT=1,2,3, C=1,1,1, CT=0.1,0.1,0.1, FORCE=1,0,0, TORQUE=0,1,0
VTORQUE/1, I=21, JFLOAT=39, RM=1, TX=1\ TY=2\ TZ=3
VFORCE/1, I=21, JFLOAT=39, FX=1\ FY=2\ FZ=-10*VZ(21,31,30,30)
SPRINGDAMPER/1, TRANS, I=20, J=30, K=5, C=1, LENGTH=0.5, FORCE=2
"""
    )
    solution = run(text)
    linear, angular = np.zeros(3), np.zeros(3)
    for name, mass, moments in (("PART_2", 2, (0.1, 0.1, 0.2)), ("PART_3", 3, (0.3, 0.2, 0.4))):
        place, velocity, omega = (
            np.stack([solution[f"{name}.{c}"] for c in names.split()]).T for names in ("x y z", "vx vy vz", "wx wy wz")
        )
        w, x, y, z = (solution[f"{name}.q{k}"] for k in range(4))
        turned = np.stack([
            np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)]),
            np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)]),
            np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]),
        ])  # fmt: skip
        linear = linear + mass * velocity
        angular = angular + mass * np.cross(place, velocity) + np.einsum("ijn,nj->ni", turned, omega * moments)
    np.testing.assert_allclose(linear, np.broadcast_to(linear[0], linear.shape), atol=1e-6)
    np.testing.assert_allclose(angular, np.broadcast_to(angular[0], angular.shape), atol=1e-5)


@pytest.mark.long
def test_springs_bushings_fields_and_beams_start_with_their_forces():
    """At a known displacement and velocity of marker I in the axes of J, the force is what the statement says."""
    text = r"""PART/2, MASS=1, CM=20, IP=1,1,1, QG=0.1,0.2,0.3, VX=1, VY=2, VZ=3, WX=0.1, WY=0.2, WZ=0.3
MARKER/20, PART=2
BUSHING/1, I=20, J=1, K=1,2,3, KT=4,5,6, C=1,1,1, CT=2,2,2, FORCE=7,8,9, TORQUE=1,2,3
FIELD/1, I=20, J=1, KMATRIX=1,0,0,0,0,0, 0,2,0,0,0,4, 0,0,3,0,0,0, 0,0,0,1,0,0, 0,0,0,0,1,0, 0,4,0,0,0,9
, LENGTH=0.1,0,0,0,0,0, FORCE=1,1,1,1,1,1
SPRINGDAMPER/1, TRANS, I=20, J=1, K=10, C=2, LENGTH=0.5, FORCE=4
SPRINGDAMPER/2, ROT, I=20, J=1, KT=10, CT=2, ANGLE=30D, TORQUE=4
BEAM/1, I=20, J=1, LENGTH=0.1, AREA=1E-4, IXX=2E-10, IYY=1E-10, IZZ=1E-10, EMODULUS=1E6, GMODULUS=1E6
"""
    solution = run(text, 1e-6)
    place, v, w = np.array([0.1, 0.2, 0.3]), np.array([1.0, 2, 3]), np.array([0.1, 0.2, 0.3])

    def acting(name):
        return np.array([[solution[f"{name}.{kind}{axis}"][0] for axis in "xyz"] for kind in "ft"])

    np.testing.assert_allclose(acting("BUSHING_1"), [[7, 8, 9] - [1, 2, 3] * place - v, [1, 2, 3] - 2 * w], atol=1e-9)
    np.testing.assert_allclose(acting("FIELD_1"), [[1, 1 - 2 * 0.2, 1 - 3 * 0.3], [1, 1, 1 - 4 * 0.2]], atol=1e-9)
    length = np.linalg.norm(place)
    force = 4 - 10 * (length - 0.5) - 2 * (place @ v) / length
    np.testing.assert_allclose(acting("SPRINGDAMPER_1")[0], force * place / length, atol=1e-9)
    np.testing.assert_allclose(acting("SPRINGDAMPER_2")[1], [0, 0, 4 + 10 * math.pi / 6 - 2 * 0.3], atol=1e-9)
    bending = 12 * 1e6 * 1e-10 / 0.1**3  # the beam ends at x = 0.1, without stretch
    moment = 6 * 1e6 * 1e-10 / 0.1**2
    expected = [[0, -bending * 0.2, -bending * 0.3], [0, -moment * 0.3, moment * 0.2]]
    np.testing.assert_allclose(acting("BEAM_1"), expected, atol=1e-9)


@pytest.mark.long
def test_a_force_by_formula():
    """A pendulum of a point mass on a rod, braked in one sense only: IF, VARVAL, SIGN and a step in time."""
    text = (
        GRAVITY
        + r"""POINT_MASS/2, MASS=1.5, CM=20, QG=2,0,0
MARKER/20, POINT_MASS=2
GCON/1, I=1, FUNCTION=DM(20,1)-2
GCON/2, FUNCTION=DY(20,1)
VARIABLE/1, FUNCTION=VX(20)
VARIABLE/2, FUNCTION=IF(VARVAL(1): -3*VARVAL(1), 0, -VARVAL(1))
VFORCE/1, I=20, JFLOAT=19, RM=1, FX=VARVAL(2) + STEP(TIME,0.2,0,0.6,2)\ FY=0\ FZ=0
MARKER/19, PART=1, FLOATING
"""
    )
    solution = run(text, 3.0)

    def rates(t, state):
        angle, rate = state
        vx = -2 * math.sin(angle) * rate
        z = min(max((t - 0.2) / 0.4, 0), 1)
        fx = (-3 * vx if vx < 0 else -vx) + 2 * z * z * (3 - 2 * z)
        return [rate, (-fx * math.sin(angle) - 1.5 * G * math.cos(angle)) / (1.5 * 2)]

    exact = solve_ivp(rates, (0, 3), [0, 0], rtol=1e-11, atol=1e-11, t_eval=solution.t).y
    np.testing.assert_allclose(solution["POINT_MASS_2.x"], 2 * np.cos(exact[0]), atol=1e-6)
    np.testing.assert_allclose(solution["POINT_MASS_2.z"], 2 * np.sin(exact[0]), atol=1e-6)
    assert np.max(np.abs(solution["POINT_MASS_2.q0"] - 1)) < 1e-9


@pytest.mark.long
def test_a_motion_and_a_force_by_splines_in_millimetres():
    """A slider led by a cubic spline of time; a second one pushed by Akima's curve of the distance between both."""
    from scipy.interpolate import Akima1DInterpolator, CubicSpline

    x, y = [0, 0.5, 1, 1.5, 2], [0, 40, 30, 80, 100]
    distances, forces = [0, 400, 800, 1200, 2000], [5, 4, 1, 0, -2]
    text = (
        HEAD.replace("LENGTH=METER", "LENGTH=MILLIMETER")
        + f"""PART/2, MASS=2, CM=20, IP=1,1,1
MARKER/20, PART=2, REULER=90D,90D,0
PART/3, MASS=3, CM=30, IP=1,1,1, QG=700,0,0
MARKER/30, PART=3, REULER=90D,90D,0
MARKER/11, PART=1, REULER=90D,90D,0
JOINT/1, TRANSLATIONAL, I=20, J=11
JOINT/2, TRANSLATIONAL, I=30, J=11
SPLINE/1, X={", ".join(map(str, x))}
, Y = {", ".join(map(str, y))}
SPLINE/2, X={", ".join(map(str, distances))}, Y={", ".join(map(str, forces))}
MOTION/1, JOINT=1, FUNCTION=CUBSPL(TIME,0,1,0)
SFORCE/1, TRANSLATIONAL, I=30, J=20, FUNCTION=AKISPL(DM(30,20),0,2,0)
END
"""
    )
    solution = stiffmbs.run(read_adams(text), duration=2.0, rtol=1e-9)
    lead, push = CubicSpline(x, y, bc_type="not-a-knot"), Akima1DInterpolator(distances, forces)
    np.testing.assert_allclose(solution["PART_2.x"], lead(solution.t) / 1000, atol=1e-9)

    def rates(t, state):
        return [state[1], push(1000 * state[0] - lead(t)) / 3]

    exact = solve_ivp(rates, (0, 2), [0.7, 0], rtol=1e-11, atol=1e-11, t_eval=solution.t, max_step=0.01).y
    np.testing.assert_allclose(solution["PART_3.x"], exact[0], atol=1e-6)


@pytest.mark.long
def test_the_force_between_two_markers_is_that_of_all_that_acts_there():
    """FX .. TZ(i, j, rm) and REQUEST/FORCE: joint, motion of the joint, and forces; of FX(i) the elements of all markers."""
    text = r"""MARKER/10, PART=1
PART/2, MASS=1, CM=20, IP=1,1,1
MARKER/20, PART=2
MARKER/21, PART=2, QP=0,0,0.2
JOINT/1, REVOLUTE, I=20, J=10
MOTION/1, JOINT=1, ROTATIONAL, FUNCTION=0.5*TIME**2
SFORCE/1, ROTATIONAL, I=20, J=10, FUNCTION=3
SFORCE/2, TRANSLATIONAL, ACTIONONLY, I=21, J=10, FUNCTION=7
REQUEST/1, FORCE, I=20, J=10
VARIABLE/1, FUNCTION=TZ(20,10,10)
VARIABLE/2, FUNCTION=TZ(10,20)
VARIABLE/3, FUNCTION=TZ(20)
VARIABLE/4, FUNCTION=TZ(10)
VARIABLE/5, FUNCTION=FZ(10,21)
VARIABLE/6, FUNCTION=FZ(21,10)
VARIABLE/7, FUNCTION=FZ(10)
"""
    found = run(text, 0.1)
    motion, all_torque = 1.0 - 3.0, 1.0  # the inertia is accelerated at 1 rad/s^2
    np.testing.assert_allclose(found["MOTION_1.tz"], motion, atol=1e-9)
    np.testing.assert_allclose(found["REQUEST_1.tz"], all_torque, atol=1e-9)
    np.testing.assert_allclose(found["VARIABLE_1"], all_torque, atol=1e-9)
    np.testing.assert_allclose(found["VARIABLE_3"], all_torque, atol=1e-9)
    for name in ("VARIABLE_2", "VARIABLE_4"):
        np.testing.assert_allclose(found[name], -all_torque, atol=1e-9)
    np.testing.assert_allclose(found["VARIABLE_5"], 0.0, atol=1e-12)
    np.testing.assert_allclose(found["VARIABLE_6"], 7.0, atol=1e-12)
    np.testing.assert_allclose(found["VARIABLE_7"], -found["JOINT_1.fz"], atol=1e-9)


ELEMENTS = r"""
MARKER/33, PART=3, QP=0.1,0.2,0.3, REULER=40D,50D,60D
MARKER/39, PART=3, FLOATING
SFORCE/1, TRANS, I=21, J=31, FUNC=3-20*DM(21,31)+VR(21,31)
SFORCE/2, ROT, ACTION, I=21, J=31, FUNC=1.5*DM(21,31)
SPRINGDAMPER/3, TRANS, I=20, J=33, K=5, C=1, LENGTH=0.5, FORCE=2
GFORCE/4, I=21, JFLOAT=39, RM=33, FX=1\ FY=-2*DM(21,33)\ FZ=3\ TX=0.3\ TY=0.5\ TZ=-0.7
VFORCE/5, I=21, JFLOAT=39, FX=1\ FY=2\ FZ=-3
BUSHING/6, I=21, J=33, K=10,20,30, KT=1,2,3, C=1,2,3, CT=0.1,0.1,0.1, FORCE=1,0,0
VTORQUE/7, I=21, JFLOAT=39, RM=33, TX=1\ TY=2\ TZ=4
"""


@pytest.mark.long
@pytest.mark.sampled(6)
@pytest.mark.parametrize("name", ["SFORCE(1", "SFORCE(2", "SPDP(3", "GFORCE(4", "VFORCE(5", "BUSH(6", "VTORQ(7"])
def test_forces_follow_other_forces(name):
    """A torque by a component of another force is that component, as a VARIABLE reports it."""
    components = (1, 2) if name == "BUSH(6" else (1, 2, 5, 8)
    terms = [f"{name},0,{component},33)" for component in components] + [f"{name},1,4,0)", f"{name},1,3,33)"]
    followers = "".join(
        f"SFORCE/{k}, ROT, ACTION, I=20, J=1, FUNC={term}\nVARIABLE/{k}, FUNC={term}\n"
        for k, term in enumerate(terms, start=100)
    )
    moving = TWO.replace("QG=1,0,0", "QG=1,0.2,0.1, REULER=20D,30D,0, VX=1, WX=1, WY=2, WZ=3")
    solution = run(moving + ELEMENTS + followers, 1e-6)
    for k, term in enumerate(terms, start=100):
        assert solution[f"SFORCE_{k}.tz"][0] == pytest.approx(solution[f"VARIABLE_{k}"][0], rel=1e-9, abs=1e-9), term


PAIRS = """
SPRINGDAMPER/8, TRANS, I=21, J=31, K=7, LENGTH=0.5
SFORCE/9, ROT, I=20, J=33, FUNC=2*DM(21,31)
MARKER/22, PART=2, QP=0.2,0.1,-0.3, REULER=20D,30D,40D
MARKER/12, PART=1, QP=0.2,0.1,-0.3
JOINT/1, SPHERICAL, I=22, J=12
SFORCE/10, ACTION, ROT, I=22, J=12, FUNC=3
"""


@pytest.mark.long
@pytest.mark.sampled(4)
@pytest.mark.parametrize("pair", ["31,21", "21,0", "22,12", "33,20"])
def test_forces_follow_all_that_acts_between_two_markers(pair):
    terms = [f"{name}({pair},22)" for name in ("FX", "FM", "TZ")] + [f"FZ({pair})"]
    followers = "".join(
        f"SFORCE/{k}, ROT, ACTION, I=20, J=1, FUNC={term}\nVARIABLE/{k}, FUNC={term}\n"
        for k, term in enumerate(terms, start=100)
    )
    moving = TWO.replace("QG=1,0,0", "QG=1,0.2,0.1, REULER=20D,30D,0, VX=1, WX=1, WY=2, WZ=3")
    without = "\n".join(line for line in ELEMENTS.splitlines() if "BUSHING" not in line)
    solution = run(moving + without + PAIRS + followers, 1e-6)
    for k, term in enumerate(terms, start=100):
        assert solution[f"SFORCE_{k}.tz"][0] == pytest.approx(solution[f"VARIABLE_{k}"][0], rel=1e-8, abs=1e-8), term


@pytest.mark.long
def test_a_block_rubs_by_the_force_that_presses_it():
    """Mass 2 on a spring that carries its weight: the friction 0.3 m g slows it from 4 m/s."""
    text = (
        GRAVITY
        + f"""PART/2, MASS=2, CM=20, IP=1,1,1, VX=4
MARKER/20, PART=2
MARKER/21, PART=2, REULER=90D,90D,0
MARKER/2, PART=1, REULER=90D,90D,0
JPRIM/1, ORIENTATION, I=20, J=1
JPRIM/2, INPLANE, I=20, J=3
MARKER/3, PART=1, REULER=0,90D,0
VARIABLE/1, FUNC=SFORCE(1,0,4,0)
SFORCE/1, TRANS, ACTION, I=20, J=1, FUNC=-1E4*(DZ(20)-{2 * G / 1e4!r})-50*VZ(20)
SFORCE/2, TRANS, ACTION, I=20, J=2, FUNC=-0.3*VARVAL(1)*STEP(VX(20), -0.01, -1, 0.01, 1)
"""
    )
    solution = run(text)
    np.testing.assert_allclose(solution["PART_2.vx"], 4 - 0.3 * G * solution.t, atol=1e-6)


@pytest.mark.parametrize(
    ("law", "words"),
    [
        ("SFORCE(1,0,1,0)", "found the force of SFORCE/1 in its own law"),
        ("VARVAL(1)", "found the force of SFORCE/1 in its own law"),
        ("SFORCE(2,0,1,0)", r"found SFORCE\(2, ...\), expected the number of a SFORCE"),
        ("FX(21,31)", "found the force of SFORCE/1 in its own law"),
        ("FX(20,30)", "found the force of BEAM/7 in 'FX.*expected it in a REQUEST, or that of a joint, or of SFORCE"),
        ("BEAM(7,0,1,0)", "found BEAM in 'BEAM.*expected it in a REQUEST, or one of JOINT, JPRIM, SFORCE"),
        ("FX(20,1)", "found no joint and no force between the markers 20 and 1"),
        ("BUSH(6,0,8,0)", "found the torque of BUSHING/6, expected it in a REQUEST only"),
    ],
)
def test_forces_that_cannot_be_followed_are_named(law, words):
    more = (
        "BUSHING/6, I=20, J=31, K=10,20,30, KT=1,2,3\n"
        "BEAM/7, I=20, J=30, LENGTH=1, AREA=1E-4, IXX=1E-9, IYY=1E-9, IZZ=1E-9, EMODULUS=1E9, GMODULUS=4E8\n"
    )
    with pytest.raises(stiffmbs.InputError, match=words):
        run(f"{TWO}{more}VARIABLE/1, FUNC=SFORCE(1,0,1,0)\nSFORCE/1, TRANS, I=21, J=31, FUNC={law}", 0.01)
