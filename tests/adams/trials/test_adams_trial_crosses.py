"""FRICTION of universal and Hooke joints against equations that share no code."""

import numpy as np
import pytest

from stiffmbs import InputError
from stiffmbs.adams.load import read_adams

from . import adams_joints
from .adams_oracle import Marker, Part, euler, tensor
from .adams_random_statements import PressedMechanism, mu, pulled, rising
from .adams_trials import moves_alike, played

TIMES = np.linspace(0, 0.4, 21)
PIN, COLLAR, BENDING, PRELOAD = 0.1, 0.05, 0.2, 0.3
LAW = """FRICTION/1, JOINT=1, MU_STATIC=0.4, MU_DYNAMIC=0.3, PIN_RADIUS=0.1, FRICTION_ARM=0.05, BENDING_REACTION_ARM=0.2
, STICTION_TRANSITION_VELOCITY=0.2, TRANSITION_VELOCITY_COEFFICIENT=2, FRICTION_TORQUE_PRELOAD=0.3{more}
"""
TEXT = """ACCGRAV/KGRAV=-9.80665
MARKER/11, PART=1, QP=0.2,0.1,0.5, REULER=30D,70D,20D
PART/2, QG=0.3,-0.1,0.4, REULER=0D,0D,0D, MASS=2, CM=21, IP=0.05,0.04,0.06{spin}
MARKER/21, PART=2
MARKER/22, PART=2, QP=-0.1,0.2,0.1, REULER={turn}
JOINT/1, {kind}, I=22, J=11
"""
CENTER, AT = (0.3, -0.1, 0.4), (0.2, 0.1, 0.5)
ARMS = {"UNIVERSAL": "zz", "HOOKE": "xy"}


def rubbing(i, j, arms, yokes):
    """The torques about both arms by what the joint does to the part of marker I."""

    def act(view, pulls):
        force, moment = pulled(view, pulls, "joint", i)
        spin = view.spin(i).rate - view.spin(j).rate
        for end, marker, name in (("I", i, arms[0]), ("J", j, arms[1])):
            if end not in yokes:
                continue
            arm = view.axis(marker, name).value
            across, bend = (np.linalg.norm(load - load @ arm * arm) for load in (force, moment))
            v = PIN * spin @ arm
            load = PIN * across + COLLAR * abs(force @ arm) + PIN / BENDING * bend
            torque = -(mu(v, 0.4, 0.3, 0.2, 0.4) * load + PRELOAD * rising(v, 0.2)) * arm
            view.push(i, view.point(i).value, np.zeros(3), torque)

    return act


@pytest.mark.long
@pytest.mark.parametrize("more", ["", ", YOKE=I_YOKE", ", YOKE=J_YOKE"])
@pytest.mark.parametrize("kind", ["UNIVERSAL", "HOOKE"])
@pytest.mark.sampled(7)
def test_both_arms_of_a_cross_rub_by_force_thrust_moment_and_preload(tmp_path, kind, more):
    base = euler(30, 70, 20)
    first, second = ARMS[kind]
    arm = base[:, "xyz".index(second)]
    own = np.cross(arm, [0.3, 0.5, -0.8])
    own /= np.linalg.norm(own)
    axes = {first: own}
    order = ("xyz" * 2)["xyz".index(first) :][:3]
    axes[order[1]] = np.cross(own, arm)
    axes[order[1]] /= np.linalg.norm(axes[order[1]])
    axes[order[2]] = np.cross(own, axes[order[1]])
    turn = np.column_stack([axes[name] for name in "xyz"])
    i, j = Marker(0, AT, turn), Marker(-1, AT, base)
    spin = 6 * own + 3 * arm
    velocity = np.cross(spin, np.subtract(CENTER, AT))
    words = ", ".join(
        f"{name}={value!r}"
        for name, value in zip(("VX", "VY", "VZ", "WX", "WY", "WZ"), map(float, [*velocity, *spin]), strict=True)
    )
    theta = np.degrees(np.arccos(turn[2, 2]))
    angles = [np.degrees(np.arctan2(turn[0, 2], -turn[1, 2])), theta, np.degrees(np.arctan2(turn[2, 0], turn[2, 1]))]
    np.testing.assert_allclose(euler(*angles), turn, atol=1e-12)
    text = TEXT.format(spin=f"\n, {words}", turn=", ".join(f"{float(a)!r}D" for a in angles), kind=kind)
    solution = played(tmp_path, text + LAW.format(more=more), 0.4, rtol=1e-9)
    yokes = {"": "IJ", ", YOKE=I_YOKE": "I", ", YOKE=J_YOKE": "J"}[more]
    joint = (adams_joints.universal if kind == "UNIVERSAL" else adams_joints.hooke)(i, j)
    part = Part(2.0, tensor(0.05, 0.04, 0.06), CENTER, np.eye(3), tuple(velocity), tuple(spin))
    own_motion = PressedMechanism([part], {"joint": joint}, [], (0, 0, -9.80665), [rubbing(i, j, ARMS[kind], yokes)])
    moves_alike(solution, "PART_2", own_motion.run(TIMES, 1e-10).part(0), 1e-6)
    assert any("friction acts on both arms of the cross" in note for note in solution.notes) == (more == "")


def test_a_yoke_is_named_by_its_marker():
    text = TEXT.format(spin="", turn="30D,70D,110D", kind="UNIVERSAL") + LAW.format(more=", YOKE=K")
    with pytest.raises(InputError, match="FRICTION/1: found YOKE = K, expected BOTH or I_YOKE or J_YOKE"):
        read_adams("a\nPART/1, GROUND\n" + text + "END\n")
