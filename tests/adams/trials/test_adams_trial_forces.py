"""Forces of Adams datasets, by functions and by constants, against equations of motion that share no code."""

import numpy as np
import pytest

from .adams_oracle import Marker, Mechanism, Part, euler, tensor
from .adams_trials import moves_alike, near, played, table

pytestmark = [pytest.mark.long, pytest.mark.sampled(2)]

WEIGHT = "ACCGRAV/KGRAV=-9.80665\n"
TIMES = np.linspace(0, 1, 51)

FREE = (
    WEIGHT
    + """MARKER/1, PART=1, QP=0.1,-0.2,0.4, REULER=20D,50D,-30D
PART/2, MASS=1.5, CM=20, IP=0.05,0.04,0.02, VX=0.3, VZ=2, WX=1, WY=-30D
MARKER/20, PART=2, QP=0.3,0.1,-0.1
MARKER/21, PART=2, QP=0.35,0.2,0.1, REULER=10D,20D,30D
PART/3, MASS=2.5, CM=30, IP=0.15,0.14,0.12, VY=-0.2, WZ=0.5
MARKER/30, PART=3, QP=-0.4,0.3,0.2
MARKER/31, PART=3, QP=-0.45,0.1,0.15, REULER=40D,-20D,10D
"""
)
PARTS = [
    Part(1.5, tensor(0.05, 0.04, 0.02), (0.3, 0.1, -0.1), np.eye(3), (0.3, 0, 2), (1, -np.pi / 6, 0)),
    Part(2.5, tensor(0.15, 0.14, 0.12), (-0.4, 0.3, 0.2), np.eye(3), (0, -0.2, 0), (0, 0, 0.5)),
]
BASE = Marker(-1, (0.1, -0.2, 0.4), euler(20, 50, -30))
A, B = Marker(0, (0.35, 0.2, 0.1), euler(10, 20, 30)), Marker(1, (-0.45, 0.1, 0.15), euler(40, -20, 10))


def compare(folder, text, forces, elements, tolerance=2e-7, duration=1.0):
    """Both parts, and what each element (name -> function of a view) does to the part of marker A, about A."""
    solution, history = (
        played(folder, FREE + text, duration),
        Mechanism(PARTS, {}, forces).run(TIMES[duration >= TIMES]),
    )
    for k, body in enumerate(("PART_2", "PART_3")):
        moves_alike(solution, body, history.part(k), tolerance)
    for name, force in elements.items():
        near(table(solution, name), history.ask(force), 100 * tolerance)


def between(view, i, j):
    """Vector from j to i, distance, and its rate: DM and VR."""
    gap = view.point(i) - view.point(j)
    long = gap.length()
    return gap.value / long.value, float(long.value), float(long.rate)


def step(x, a, p, b, q):
    s = np.clip((x - a) / (b - a), 0, 1)
    return p + (q - p) * s * s * (3 - 2 * s)


def pair(view, i, j, force, torque=(0, 0, 0)):
    """Action on the part of i at i, reaction on that of j at the same place, as Adams' J or JFLOAT takes it."""
    at = view.point(i).value
    view.push(i, at, force, torque)
    view.push(j, at, -np.array(force), -np.array(torque))


def test_a_strut_by_if_step_and_abs(tmp_path):
    """Positive forces drive the markers apart; IF has its branches in the order negative: zero, positive."""
    text = r"""SFORCE/1, TRANSLATIONAL, I=21, J=31, FUNCTION= -40*(DM(21,31)-0.7)
, - IF(VR(21,31): 2*VR(21,31), 0, 5*VR(21,31)) + STEP(TIME, 0.2, 0, 0.7, 6)
, + 0.3*ABS(DX(21,31,1))*MAX(0.1, MIN(DZ(21,31), 0.5)) """

    def size(view):
        _, long, rate = between(view, A, B)
        gap = view.point(A).value - view.point(B).value
        along = gap @ view.axes(BASE)[:, 0]
        damping = 2 * rate if rate < 0 else 5 * rate
        return (
            -40 * (long - 0.7) - damping + step(view.t, 0.2, 0, 0.7, 6) + 0.3 * abs(along) * max(0.1, min(gap[2], 0.5))
        )

    def force(view):
        return size(view) * between(view, A, B)[0]

    compare(
        tmp_path,
        text,
        [lambda view: pair(view, A, B, force(view))],
        {"SFORCE_1": lambda view: np.concatenate([force(view), np.zeros(3)])},
        2e-6,
    )


def test_action_only_forces_and_torques_along_a_moving_z(tmp_path):
    """ACTIONONLY: along the z of J, at I, nothing on J; the same marker may be both."""
    text = """SFORCE/1, TRANSLATIONAL, ACTIONONLY, I=21, J=31, FUNCTION=3+2*TIME
SFORCE/2, ROTATIONAL, ACTIONONLY, I=21, J=21, FUNCTION=0.4*SIN(3*TIME)*DX(30,31)/SQRT(DX(30,31)**2+1)
SFORCE/3, TRANS, ACTION, I=30, J=1, FUNCTION=-5"""

    def thrust(view):
        return (3 + 2 * view.t) * view.axes(B)[:, 2]

    def spin(view):
        d = (view.r[1] - view.point(B).value)[0]
        return 0.4 * np.sin(3 * view.t) * d / np.sqrt(d**2 + 1) * view.axes(A)[:, 2]

    def push(view):
        view.push(A, view.point(A).value, thrust(view), spin(view))
        view.push(B, view.r[1], -5 * BASE.turn[:, 2])

    compare(
        tmp_path,
        text,
        [push],
        {
            "SFORCE_1": lambda view: np.concatenate([thrust(view), np.zeros(3)]),
            "SFORCE_2": lambda view: np.concatenate([np.zeros(3), spin(view)]),
        },
    )


def test_a_vector_force_in_the_axes_of_a_third_marker(tmp_path):
    """FX FY FZ along RM's axes, at I; the reaction is on JFLOAT's part where I is. Functions end in backslashes."""
    text = r"""MARKER/39, PART=3, FLOATING
VFORCE/1, I=21, JFLOAT=39, RM=31, FX= -20*DX(21,31,31)-VX(21,31,31,31) \
, FY = 5*COS(2*TIME)-WZ(21,31,31)\ FZ=-30*DZ(21,31,31)
, - 2*VZ(21,31,31)
VTORQUE/2, I=21, JFLOAT=39, RM=1, TX=-0.3*WX(21,31,1)\TY=0\TZ=0.2*TIME"""

    def force(view):
        axes = view.axes(B)
        gap, arm = view.point(A) - view.point(B), view.w[1]
        along, rate = axes.T @ gap.value, axes.T @ gap.rate
        seen = axes.T @ (gap.rate - np.cross(arm, gap.value))  # as an observer on part 3 sees it
        turning = axes.T @ (view.w[0] - view.w[1])
        return axes @ [-20 * along[0] - seen[0], 5 * np.cos(2 * view.t) - turning[2], -30 * along[2] - 2 * rate[2]]

    def torque(view):
        axes = BASE.turn
        return axes @ [-0.3 * (axes.T @ (view.w[0] - view.w[1]))[0], 0, 0.2 * view.t]

    compare(
        tmp_path,
        text,
        [lambda view: pair(view, A, B, force(view), torque(view))],
        {
            "VFORCE_1": lambda view: np.concatenate([force(view), np.zeros(3)]),
            "VTORQUE_2": lambda view: np.concatenate([np.zeros(3), torque(view)]),
        },
    )


def test_a_general_force_with_its_reaction_on_a_moving_part(tmp_path):
    text = r"""MARKER/39, PART=3, FLOATING
GFORCE/1, I=21, JFLOAT=39, RM=21
, FX=-10*DM(21,31)\FY=2\FZ=VM(21,31)\TX=0.1*WM(21)\TY=-0.2*VR(21,31)
, \TZ=SIGN(0.1,TIME-0.5)*(TIME-0.5)"""

    def force(view):
        _, long, _ = between(view, A, B)
        speed = np.linalg.norm((view.point(A) - view.point(B)).rate)
        return view.axes(A) @ [-10 * long, 2, speed]

    def torque(view):
        rate = between(view, A, B)[2]
        return view.axes(A) @ [0.1 * np.linalg.norm(view.w[0]), -0.2 * rate, 0.1 * abs(view.t - 0.5)]

    compare(
        tmp_path,
        text,
        [lambda view: pair(view, A, B, force(view), torque(view))],
        {"GFORCE_1": lambda view: np.concatenate([force(view), np.zeros(3)])},
        1e-6,
    )


def test_springs_with_reference_forces(tmp_path):
    """Force = FORCE - K (DM - LENGTH) - C VR: positive drives apart."""
    text = """SPRINGDAMPER/1, TRANSLATION, I=21, J=31, K=60, C=1.5, FORCE=4, LENGTH=0.65
SPRINGDAMPER/2, I=30, J=1, TRANS, K=20, LENGTH=0.3, C=0"""

    def one(view):
        way, long, rate = between(view, A, B)
        return (4 - 60 * (long - 0.65) - 1.5 * rate) * way

    center = Marker(1, PARTS[1].center)

    def two(view):
        way, long, _ = between(view, center, BASE)
        return -20 * (long - 0.3) * way

    def push(view):
        pair(view, A, B, one(view))
        view.push(B, view.r[1], two(view))

    compare(tmp_path, text, [push], {"SPRINGDAMPER_1": lambda view: np.concatenate([one(view), np.zeros(3)])})


def test_a_bushing_of_small_rotations_and_large_shifts(tmp_path):
    """Along and about J's crooked axes, preloads in them, J on a moving part, the reaction where I is.

    Adams' rotations a, b, c and the rotation vector agree to first order, so rotations are held small by stiff KT,
    and what is left differs by their squares.
    """
    place = "0.05,-0.1,0.2"
    text = f"""MARKER/22, PART=2, QP={place}, REULER=40D,-20D,10D
MARKER/32, PART=3, QP={place}, REULER=40D,-20D,10D
BUSHING/1, I=22, J=32
, K=300,200,500, C=3,2,1, KT=4000,5000,6000, CT=20,30,40
, FORCE=1,2,-3, TORQUE=0.1,-0.2,0.3"""
    turn = euler(40, -20, 10)
    i, j = Marker(0, (0.05, -0.1, 0.2), turn), Marker(1, (0.05, -0.1, 0.2), turn)

    def components(view):
        axes, own = view.axes(j), view.axes(i)
        gap = view.point(i) - view.point(j)
        seen = axes.T @ (gap.rate - np.cross(view.w[1], gap.value))
        force = [1, 2, -3] - np.array([300, 200, 500]) * (axes.T @ gap.value) - np.array([3, 2, 1]) * seen
        relative = axes.T @ own
        small = 0.5 * np.array(
            [relative[2, 1] - relative[1, 2], relative[0, 2] - relative[2, 0], relative[1, 0] - relative[0, 1]]
        )
        torque = [0.1, -0.2, 0.3] - np.array([4000, 5000, 6000]) * small
        torque = torque - np.array([20, 30, 40]) * (axes.T @ (view.w[0] - view.w[1]))
        return axes @ force, axes @ torque

    compare(tmp_path, text, [lambda view: pair(view, i, j, *components(view))], {}, 5e-6, 0.5)


TURNING = (
    WEIGHT
    + """MARKER/1, PART=1, QP=0.1,-0.2,0.4, REULER=20D,50D,-30D
PART/2, MASS=1.5, CM=20, IP=0.05,0.04,0.02
MARKER/20, PART=2, QP=0.3,0.1,-0.1
MARKER/21, PART=2, QP=0.1,-0.2,0.4, REULER=20D,50D,-30D
MARKER/22, PART=2, QP=0.1,-0.2,0.4, REULER=20D,50D,10D
JOINT/1, REVOLUTE, I=21, J=1
"""
)


def hinged(torque, spin=0.0):
    """One turn about BASE's z by quadrature of one coordinate: angle from the start over time, by DOP853."""
    from scipy.integrate import solve_ivp

    z, arm = BASE.turn[:, 2], np.array([0.3, 0.1, -0.1]) - np.array([0.1, -0.2, 0.4])
    across = arm - (arm @ z) * z
    inertia = z @ tensor(0.05, 0.04, 0.02) @ z + 1.5 * across @ across

    def rates(t, y):
        turned = np.cos(y[0]) * across + np.sin(y[0]) * np.cross(z, across)
        return [y[1], (torque(t, *y) + 1.5 * np.cross(turned, [0, 0, -9.80665]) @ z) / inertia]

    return solve_ivp(rates, (0, 3), [0, spin], "DOP853", t_eval=np.linspace(0, 3, 151), rtol=1e-12, atol=1e-12).y


def angles(solution):
    return solution.channels["REQUEST_1.f2"], solution.channels["REQUEST_1.f3"]


ASKED = r"REQUEST/1, F2=AZ(22,1)\F3=WZ(22,1,1)"


def test_a_torsion_spring_counts_whole_turns(tmp_path):
    """Started fast it turns more than once; AZ of a marker that leads by 40 degrees goes on past half a turn."""
    lead = np.radians(40)
    text = (
        TURNING.replace("0.02\n", f"0.02{start(14.0)}\n", 1)
        + "SFORCE/1, ROTATIONAL, I=22, J=1, FUNCTION=-0.8*(AZ(22,1)-30D)-0.05*WZ(22,1,1)\n"
        + ASKED
    )
    angle, rate = hinged(lambda t, a, w: -0.8 * (a + lead - np.pi / 6) - 0.05 * w, 14.0)
    assert angle.max() > 3.5  # more than half a turn, or the test tests nothing
    solution = played(tmp_path, text, 3.0)
    near(angles(solution)[0], angle + lead, 1e-6)
    near(angles(solution)[1], rate, 1e-6)


def start(spin):
    """VX .. WZ of TURNING's part turning about BASE's z: its CM marker has ground's axes."""
    z, arm = BASE.turn[:, 2], np.array([0.3, 0.1, -0.1]) - np.array([0.1, -0.2, 0.4])
    v, w = np.cross(spin * z, arm), spin * z
    return "".join(f", {n}={x:.16g}" for n, x in zip(["VX", "VY", "VZ", "WX", "WY", "WZ"], [*v, *w], strict=True))


def test_a_rotational_springdamper_in_degrees(tmp_path):
    """TORQUE - KT (AZ - ANGLE) - CT WZ, ANGLE in degrees, I on the ground: it turns the other part back."""
    text = TURNING + "SPRINGDAMPER/1, ROTATION, I=1, J=22, KT=2, CT=0.1, TORQUE=0.5, ANGLE=30D\n" + ASKED
    lead = np.radians(40)

    def torque(t, a, w):  # angle of the ground's marker about the part's
        return -(0.5 - 2 * (-(a + lead) - np.pi / 6) - 0.1 * (-w))

    angle, rate = hinged(torque)
    solution = played(tmp_path, text, 3.0)
    near(angles(solution)[0], angle + lead, 1e-6)
    near(angles(solution)[1], rate, 1e-6)


def test_tilting_angles_ax_and_ay(tmp_path):
    """AX = atan2(-zi.yj, zi.zj), AY = atan2(zi.xj, zi.zj), AZ = atan2(xi.yj, xi.xj) in a torque's functions."""
    text = r"""VTORQUE/1, I=21, JFLOAT=39, RM=31, TX=-0.2*AX(21,31)\TY=0.3*AY(21,31)\TZ=-0.1*AZ(21,31)
MARKER/39, PART=3, FLOATING"""

    def torque(view):
        i, j = view.axes(A), view.axes(B)
        zi, xi = i[:, 2], i[:, 0]
        ax = np.arctan2(-zi @ j[:, 1], zi @ j[:, 2])
        ay = np.arctan2(zi @ j[:, 0], zi @ j[:, 2])
        az = np.arctan2(xi @ j[:, 1], xi @ j[:, 0])
        return j @ [-0.2 * ax, 0.3 * ay, -0.1 * az]

    compare(
        tmp_path,
        text,
        [lambda view: pair(view, A, B, np.zeros(3), torque(view))],
        {"VTORQUE_1": lambda view: np.concatenate([np.zeros(3), torque(view)])},
        duration=0.6,  # AX, AY and AZ stay within half a turn
    )
