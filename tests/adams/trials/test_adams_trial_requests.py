"""Requests and variables of Adams datasets against index-1 equations that share no code."""

import numpy as np
import pytest

from . import adams_joints as joints
from .adams_oracle import Marker, Mechanism, Part, euler, tensor
from .adams_trials import near, played, table

TIMES = np.linspace(0, 1, 51)

DATASET = r"""ACCGRAV/IGRAV=1,JGRAV=-2, KGRAV=-9
MARKER/1, PART=1, REULER=0,50D,20D
MARKER/2, PART=1, QP=0.2,0.3,-0.1, REULER=70D,-50D,20D
PART/2, MASS=1.5, CM=20, IP=0.05,0.04,0.02
MARKER/20, PART=2, QP=0.3,0.1,-0.1
MARKER/21, PART=2, REULER=0,50D,20D
MARKER/22, PART=2, QP=0.4,0,0.2, REULER=30D,40D,50D
PART/3, MASS=2, CM=30, IP=0.15,0.14,0.12, QG=0.4,0,0.2, REULER=30D,40D,50D, WX=0.4, WY=20D, VX={vx}, VY={vy}, VZ={vz}
MARKER/30, PART=3, QP=0.1,0.05,-0.1, REULER=10D,20D,0
MARKER/31, PART=3
MARKER/32, PART=3, QP=0.2,0.1,0.1, REULER=-20D,80D,10D
JOINT/1, REVOLUTE, I=21, J=1
JOINT/2, SPHERICAL, I=22, J=31
SFORCE/1, TRANSLATION, I=32, J=2, FUNCTION=-30*(DM(32,2)-0.5)
VTORQUE/1, I=32, JFLOAT=29, RM=2, TX=0.1\TY=0.2*TIME\TZ=-0.1
MARKER/29, PART=2, FLOATING
REQUEST/1, DISPLACEMENT, I=32, J=22, RM=22
REQUEST/2, D, J=2, I=32
REQUEST/3, VELOCITY, I=32, J=22
REQUEST/4, V, I=32, J=22, RM=30
REQUEST/5, ACCELERATION, I=32, J=22, RM=2
REQUEST/6, FORCE, I=22, J=31
REQUEST/7, FORCE, I=31, J=22, RM=32
REQUEST/8, F, I=32, J=2, RM=21
REQUEST/9, D, I=30
REQUEST/11, F1=DX(32,22,2)\F2=DY(32)\F3=DZ(32,22)\F4=DM(32)\F5=VX(32,22,2,22)\F6=VR(32,2)\F7=WX(32,22,30)\F8=WM(32,22)
REQUEST/12, F1=JOINT(2,0,1,0)\F2=JOINT(2,1,2,32)\F3=JOINT(1,1,6,0)\F4=JOINT(1,0,7,30)\F5=SFORCE(1,1,1,0)\F6=SFORCE(1,1,2,2)
, \F7=ACCX(32,22,2)\F8=WDTY(32,22,2)
REQUEST/13, F2=PSI(32,22)\F3=THETA(32,22)\F4=PHI(32,22)\F6=VARVAL(3)\F7=VM(32,22)\F8=ACCM(32,22)
REQUEST/14, F2=FX(22,31,32)\F3=TZ(32,29,2)\F4=FM(22,31)\F6=FY(32,2)\F7=VTORQ(1,0,7,2)\F8=AY(32,22)
REQUEST/15, F2=ACCX(32,22,2,22)\F3=ACCY(32,2,0,30)\F4=ACCM(30,2,22)\F6=WDTX(32,22,30,22)\F7=WDTM(32,2,22)\F8=ACCZ(32,22,2,1)
VARIABLE/3, IC=0, FUNCTION=VARVAL(4)*2+AX(32,22)
VARIABLE/4, FUNCTION=IF(TIME-0.5:1,2,3)+MAX(SIN(90D),PI)*RTOD*DTOR
"""

A, B = Marker(0, turn=euler(0, 50, 20)), Marker(-1, turn=euler(0, 50, 20))
SEAT = Marker(0, (0.4, 0, 0.2), euler(30, 40, 50))
TURN = euler(30, 40, 50)
CM = TURN @ euler(10, 20, 0)
CENTER = np.array([0.4, 0, 0.2]) + TURN @ [0.1, 0.05, -0.1]
SPIN = CM @ [0.4, np.radians(20), 0]  # about the axes of the centre-of-mass marker
BALL = Marker(1, (0.4, 0, 0.2), TURN)
TIP = Marker(1, np.array([0.4, 0, 0.2]) + TURN @ [0.2, 0.1, 0.1], TURN @ euler(-20, 80, 10))
FOOT = Marker(-1, (0.2, 0.3, -0.1), euler(70, -50, 20))
MIDDLE = Marker(1, CENTER, CM)
SPEED = np.cross(SPIN, TURN @ [0.1, 0.05, -0.1])


def pull(view):
    gap = view.point(TIP).value - view.point(FOOT).value
    return -30 * (np.linalg.norm(gap) - 0.5) * gap / np.linalg.norm(gap)


def wring(view):
    return FOOT.turn @ [0.1, 0.2 * view.t, -0.1]


def load(view):
    view.push(TIP, view.point(TIP).value, pull(view), wring(view))
    view.push(SEAT, view.point(TIP).value, (0, 0, 0), -wring(view))


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """Solution of the dataset and history of the oracle."""
    text = DATASET.format(vx=repr(float(SPEED[0])), vy=repr(float(SPEED[1])), vz=repr(float(SPEED[2])))
    parts = [
        Part(1.5, tensor(0.05, 0.04, 0.02), (0.3, 0.1, -0.1)),
        Part(2, tensor(0.15, 0.14, 0.12), CENTER, CM, SPEED, SPIN),
    ]
    every = {"JOINT_1": joints.revolute(A, B), "JOINT_2": joints.atpoint(SEAT, BALL)}
    history = Mechanism(parts, every, [load], gravity=(1, -2, -9)).run(TIMES)
    return played(tmp_path_factory.mktemp("requests"), text), history


def apart(view, i, j):
    return view.point(i).value - view.point(j).value


def rates(view, i, j):
    return view.point(i).rate - view.point(j).rate


def spins(view, i, j):
    return view.spin(i).rate - view.spin(j).rate


def body313(view, i, j):
    """psi, theta, phi of marker i's axes against j's."""
    r = view.axes(j).T @ view.axes(i)
    return [np.arctan2(r[0, 2], -r[1, 2]), np.arccos(r[2, 2]), np.arctan2(r[2, 0], r[2, 1])]


def holds(both, request, names, question, tolerance=2e-5):
    solution, history = both
    near(table(solution, request, names), history.ask(question), tolerance)


def holds_accelerations(both, request, names, question):
    solution, history = both
    rows = [question(view, accelerations) for view, accelerations, _ in history.instants]
    near(table(solution, request, names), rows, 2e-5)


@pytest.mark.long
def test_displacements(both):
    holds(both, "REQUEST_1", "x y z", lambda v: v.axes(SEAT).T @ apart(v, TIP, SEAT), 1e-6)
    holds(both, "REQUEST_1", "psi theta phi", lambda v: body313(v, TIP, SEAT), 2e-6)
    holds(both, "REQUEST_2", "x y z", lambda v: apart(v, TIP, FOOT), 1e-6)
    holds(both, "REQUEST_2", "psi theta phi", lambda v: body313(v, TIP, FOOT), 2e-6)
    holds(both, "REQUEST_9", "x y z", lambda v: v.r[1], 1e-6)


@pytest.mark.long
def test_velocities_are_differences_in_ground_resolved_in_rm(both):
    holds(both, "REQUEST_3", "vx vy vz", lambda v: rates(v, TIP, SEAT))
    holds(both, "REQUEST_3", "wx wy wz", lambda v: spins(v, TIP, SEAT))
    holds(both, "REQUEST_4", "vx vy vz", lambda v: v.axes(MIDDLE).T @ rates(v, TIP, SEAT))
    holds(both, "REQUEST_4", "wx wy wz", lambda v: v.axes(MIDDLE).T @ spins(v, TIP, SEAT))


def accelerate(view, found, i):
    """Acceleration of a marker and angular acceleration of its part, from those of the parts."""
    if i.part < 0:
        return np.zeros(3), np.zeros(3)
    k = i.part
    arm, w = view.point(i).value - view.r[k], view.w[k]
    return found[0, k] + np.cross(found[1, k], arm) + np.cross(w, np.cross(w, arm)), found[1, k]


def test_accelerations_are_differences_in_ground(both):
    def linear(view, found):
        return FOOT.turn.T @ (accelerate(view, found, TIP)[0] - accelerate(view, found, SEAT)[0])

    def angular(view, found):
        return FOOT.turn.T @ (found[1, 1] - found[1, 0])

    holds_accelerations(both, "REQUEST_5", "accx accy accz", linear)
    holds_accelerations(both, "REQUEST_5", "wdtx wdty wdtz", angular)
    holds_accelerations(both, "REQUEST_12", "f7 f8", lambda v, found: [linear(v, found)[0], angular(v, found)[1]])


@pytest.mark.long
def test_accelerations_as_seen_from_moving_markers(tmp_path):
    """Derivatives of components in the frame of marker l by differences in time, of runs that are solved at close instants."""
    text = DATASET.format(vx=repr(float(SPEED[0])), vy=repr(float(SPEED[1])), vz=repr(float(SPEED[2])))
    parts = [
        Part(1.5, tensor(0.05, 0.04, 0.02), (0.3, 0.1, -0.1)),
        Part(2, tensor(0.15, 0.14, 0.12), CENTER, CM, SPEED, SPIN),
    ]
    every = {"JOINT_1": joints.revolute(A, B), "JOINT_2": joints.atpoint(SEAT, BALL)}
    step = 1e-4
    near_half = 0.5 + step * np.arange(-2, 3)
    history = Mechanism(parts, every, [load], gravity=(1, -2, -9)).run(np.append(0.0, near_half))
    solution = played(tmp_path, text, 0.5, step=0.5)
    instants = [view for view, _, _ in history.instants[1:]]

    def derivative(frame, question, order):
        """Of components in the frame, in ground axes at the middle instant."""
        rows = np.array([view.axes(frame).T @ question(view) for view in instants])
        weights = {1: [1 / 12, -2 / 3, 0, 2 / 3, -1 / 12], 2: [-1 / 12, 4 / 3, -5 / 2, 4 / 3, -1 / 12]}[order]
        return instants[2].axes(frame) @ (np.array(weights) @ rows) / step**order

    axes = instants[2].axes
    wanted = [
        (axes(FOOT).T @ derivative(SEAT, lambda v: apart(v, TIP, SEAT), 2))[0],
        derivative(MIDDLE, lambda v: apart(v, TIP, FOOT), 2)[1],
        np.linalg.norm(derivative(SEAT, lambda v: apart(v, MIDDLE, FOOT), 2)),
        (axes(MIDDLE).T @ derivative(SEAT, lambda v: spins(v, TIP, SEAT), 1))[0],
        np.linalg.norm(derivative(SEAT, lambda v: spins(v, TIP, FOOT), 1)),
        (axes(FOOT).T @ derivative(B, lambda v: apart(v, TIP, SEAT), 2))[2],
    ]
    found = [solution[f"REQUEST_15.{name}"][-1] for name in ("f2", "f3", "f4", "f6", "f7", "f8")]
    np.testing.assert_allclose(found, wanted, rtol=3e-5)


def test_forces_act_on_i(both):
    solution, history = both
    ball = history.reaction("JOINT_2", SEAT)[:, :3]
    near(table(solution, "REQUEST_6", "fx fy fz"), ball, 2e-5)
    near(table(solution, "REQUEST_6", "fm tm"), np.column_stack([np.linalg.norm(ball, axis=1), 0 * ball[:, 0]]), 2e-5)
    axes = history.ask(lambda v: v.axes(TIP))
    near(table(solution, "REQUEST_7", "fx fy fz"), np.einsum("tij,ti->tj", axes, -ball), 2e-5)
    holds(both, "REQUEST_8", "fx fy fz", lambda v: v.axes(A).T @ pull(v))
    near(table(solution, "REQUEST_14", "f2"), np.einsum("tij,ti->tj", axes, ball)[:, :1], 2e-5)
    near(table(solution, "REQUEST_14", "f4"), np.linalg.norm(ball, axis=1)[:, None], 2e-5)
    holds(both, "REQUEST_14", "f3 f6 f7", lambda v: [-0.1, pull(v)[1], 0.2 * v.t])


def test_functions_of_joints(both):
    solution, history = both
    ball, hinge = history.reaction("JOINT_2", SEAT)[:, :3], history.reaction("JOINT_1", A)
    far = history.reaction("JOINT_1", B)
    tip, middle = history.ask(lambda v: v.axes(TIP)), history.ask(lambda v: v.axes(MIDDLE))
    wanted = [
        np.linalg.norm(ball, axis=1),
        np.einsum("tij,ti->tj", tip, -ball)[:, 0],
        far[:, 3],
        np.einsum("tij,ti->tj", middle, hinge[:, 3:])[:, 1],
    ]
    near(table(solution, "REQUEST_12", "f1 f2 f3 f4"), np.column_stack(wanted), 2e-5)
    holds(both, "REQUEST_12", "f5 f6", lambda v: [np.linalg.norm(pull(v)), -(FOOT.turn.T @ pull(v))[0]])


def test_functions_of_markers(both):
    def listed(v):
        gap, rate = apart(v, TIP, SEAT), rates(v, TIP, SEAT)
        seen = rate - np.cross(v.w[0], gap)
        far = apart(v, TIP, FOOT)
        return [
            FOOT.turn[:, 0] @ gap,
            v.point(TIP).value[1],
            gap[2],
            np.linalg.norm(v.point(TIP).value),
            FOOT.turn[:, 0] @ seen,
            far @ rates(v, TIP, FOOT) / np.linalg.norm(far),
            v.axes(MIDDLE)[:, 0] @ spins(v, TIP, SEAT),
            np.linalg.norm(spins(v, TIP, SEAT)),
        ]

    holds(both, "REQUEST_11", "f1 f2 f3 f4 f5 f6 f7 f8", listed)


def test_angles_and_variables(both):
    def tilt(v):
        i, j = v.axes(TIP), v.axes(SEAT)
        return np.arctan2(-i[:, 2] @ j[:, 1], i[:, 2] @ j[:, 2])

    def lean(v):
        z = v.axes(TIP)[:, 2]
        return np.arctan2(z @ v.axes(SEAT)[:, 0], z @ v.axes(SEAT)[:, 2])

    def fourth(v):
        return (1 if v.t < 0.5 else 3) + np.pi

    solution, history = both
    turned = table(solution, "REQUEST_13", "f2 f3 f4") - history.ask(lambda v: body313(v, TIP, SEAT))
    turned = np.column_stack([turned, solution.channels["REQUEST_14.f8"] - history.ask(lean)])
    near(np.sin(turned / 2), 0 * turned, 2e-6, 1.0)  # whole turns do not count
    late = np.abs(TIMES - 0.5) > 0.01
    near(table(solution, "REQUEST_13", "f6")[late, 0], history.ask(lambda v: 2 * fourth(v) + tilt(v))[late], 2e-6)
    near(solution.channels["VARIABLE_4"][late], history.ask(fourth)[late], 1e-9)
    holds(both, "REQUEST_13", "f7", lambda v: [np.linalg.norm(rates(v, TIP, SEAT))])


ODD = r"""t
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
MARKER/1, PART=1, REULER=30D,0,0
MARKER/9, FLOATING
PART/2, MASS=1, CM=20, IP=1,1,1
MARKER/20, QP=1,0,0
GCON/1, I=20, FUNCTION=DX(20)**2+DZ(20)**2-1
SFORCE/1, TRANS, ACTIONONLY, I=20, J=1, FUNCTION=3
GFORCE/1, I=20, JFLOAT=9, RM=20, FX=1\FY=2\FZ=3\TX=4\TY=5\TZ=6
REQUEST/1, F2=GCON(1,1,2,0)\F3=GCON(1,0,2,0)\F4=SFORCE(1,1,4,0)\F6=DX(20,,1)\F7=VX(20,,1)
REQUEST/2, F2=GFORCE(1,1,2,20)\F3=GFORCE(1,1,1,0)\F4=GFORCE(1,1,8,20)\F6=GFORCE(1,0,8,20)
REQUEST/3, FORCE, I=9, J=20, RM=20
REQUEST/4, DISPLACEMENT, I=9
"""


@pytest.mark.long
def test_what_floats_is_where_i_is_and_what_cannot_be_asked_is_left_out(tmp_path):
    """The reaction at a floating marker is the force turned round; a marker that is left out is ground."""
    solution = played(tmp_path, "", 0.2, head=ODD)
    first = {name: values[-1] for name, values in solution.channels.items() if name.startswith("REQUEST")}
    assert first["REQUEST_1.f4"] == 0 and first["REQUEST_1.f6"] == pytest.approx(np.cos(np.pi / 6) * solution["PART_2.x"][-1]
        + np.sin(np.pi / 6) * solution["PART_2.y"][-1])  # fmt: skip
    wanted = [-1, np.sqrt(14), -6, 6]
    np.testing.assert_allclose([first[f"REQUEST_2.{name}"] for name in ("f2", "f3", "f4", "f6")], wanted, rtol=1e-9)
    wanted = [np.sqrt(14), -1, -2, -3, np.sqrt(77), -4, -5, -6]
    np.testing.assert_allclose(
        [first[f"REQUEST_3.{name}"] for name in ("fm", "fx", "fy", "fz", "tm", "tx", "ty", "tz")], wanted, rtol=1e-9
    )
    assert "REQUEST_1.f2" not in first and "REQUEST_4.x" not in first
    told = " ".join(solution.notes)
    assert "found the force of GCON/1 on its marker J" in told and "found the floating marker 9" in told
