"""Random robots as MJCF and URDF files, with elements that need no soft constraints in MuJoCo."""

from __future__ import annotations

from typing import Any

import numpy as np

ACTUATORS = ("motor", "position", "velocity")
FLAGS = ("spring", "damper", "actuation", "gravity", "clampctrl")


def _numbers(values: Any) -> str:
    return " ".join(f"{x:.6g}" for x in np.atleast_1d(values))


class _Draw:
    """Random attributes of a robot file, planar or spatial."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng, self.planar = rng, bool(rng.uniform() < 0.4)

    def chance(self, part: float) -> bool:
        return bool(self.rng.uniform() < part)

    def some(self, part: float, text: str) -> str:
        """Return a text or an empty string."""
        return text if self.chance(part) else ""

    def uniform(self, low: float, high: float) -> str:
        return _numbers(self.rng.uniform(low, high))

    def range(self, size: float) -> str:
        """Return bounds around zero."""
        return f"{self.uniform(-size, -size / 4)} {self.uniform(size / 4, size)}"

    def point(self, size: float) -> str:
        """Return a point; in the plane of x and z for a planar robot."""
        return _numbers(self.rng.uniform(-size, size, 3) * ([1, 0, 1] if self.planar else [1, 1, 1]))

    def axis(self, kind: str) -> str:
        """Return the axis of a hinge or a slide."""
        if self.planar:
            return "0 1 0" if kind == "hinge" else _numbers([self.rng.normal(), 0, self.rng.normal()])
        return _numbers(self.rng.normal(size=3))

    def turned(self, name: str) -> str:
        """Return an attribute that rotates axes, rad; empty in the plane."""
        return "" if self.planar else f'{name}="{_numbers(self.rng.uniform(-1, 1, 3))}"'


def random_mjcf(rng: np.random.Generator) -> str:
    """Return the text of a random MJCF file."""
    draw = _Draw(rng)
    joints: list[str] = []
    bodies = "".join(_body(draw, f"tree{k}", joints, 2) for k in range(int(rng.integers(1, 3))))
    tendons, actuators = _tendon(draw, joints), ""
    for k in range(int(rng.integers(0, 4)) if joints else 0):
        kind = ACTUATORS[int(rng.integers(3))]
        on = 'tendon="belt"' if tendons and draw.chance(0.4) else f'joint="{joints[int(rng.integers(len(joints)))]}"'
        own = {"motor": "", "position": f'kp="{draw.uniform(1, 30)}"', "velocity": f'kv="{draw.uniform(0.1, 3)}"'}[kind]
        bounds = draw.some(0.3, f'ctrllimited="true" ctrlrange="{draw.range(0.5)}"')
        bounds += draw.some(0.3, f' forcelimited="true" forcerange="{draw.range(2)}"')
        actuators += (
            f'<{kind} name="act{k}" {on} {own} gear="{draw.uniform(-3, 3)}" group="{rng.integers(4)}" {bounds}/>'
        )
    flags = " ".join(f'{flag}="disable"' for flag in FLAGS if draw.chance(0.12))
    groups = draw.some(0.2, f'actuatorgroupdisable="{rng.integers(4)}"')
    gravity = "0 0 -9.81" if draw.chance(0.7) else draw.point(9)
    return (
        f'<mujoco><compiler angle="radian"/><option gravity="{gravity}" {groups}><flag contact="disable" {flags}/></option>'
        f"<worldbody>{bodies}</worldbody>{tendons}<actuator>{actuators}</actuator></mujoco>"
    )


def _body(draw: _Draw, name: str, joints: list[str], depth: int) -> str:
    """Return a body with its joints, one or two solids, and child bodies."""
    rng, held = draw.rng, ""
    kinds = ["hinge", "hinge", "slide"] + ([] if draw.planar else ["ball"])
    if depth == 2 and draw.chance(0.15):
        held = f'<joint type="free" damping="{draw.uniform(0, 1)}"/>'
    for k in range(0 if held else int(rng.choice([0, 1, 1, 1, 2])) or int(depth == 2)):
        kind = str(rng.choice(kinds))
        if kind == "ball":
            held += f'<joint name="{name}_{k}" type="ball" pos="{draw.point(0.1)}" damping="{draw.uniform(0, 1)}"/>'
            break  # no other joint stands on a ball
        own = draw.some(0.4, f'stiffness="{draw.uniform(1, 30)}" springref="{draw.uniform(-0.5, 0.5)}"')
        own += draw.some(0.4, f' damping="{draw.uniform(0.1, 1)}"') + draw.some(
            0.3, f' armature="{draw.uniform(0.05, 1)}"'
        )
        own += draw.some(0.3, f' ref="{draw.uniform(-0.5, 0.5)}"') + draw.some(
            0.3, f' actuatorfrcrange="{draw.range(1)}"'
        )
        held += f'<joint name="{name}_{k}" type="{kind}" axis="{draw.axis(kind)}" pos="{draw.point(0.1)}" {own}/>'
        joints.append(f"{name}_{k}")
    solids = "".join(_solid(draw) for _ in range(int(rng.integers(1, 3))))
    below = [_body(draw, f"{name}{k}", joints, depth - 1) for k in range(int(rng.integers(0, 3)) if depth else 0)]
    lifted = draw.some(0.2, f'gravcomp="{draw.uniform(0, 1)}"')
    return f'<body name="{name}" pos="{draw.point(0.5)}" {draw.turned("euler")} {lifted}>{held}{solids}{"".join(below)}</body>'


def _solid(draw: _Draw) -> str:
    kind = str(draw.rng.choice(["box", "sphere", "capsule", "ellipsoid", "cylinder"]))
    size = _numbers(draw.rng.uniform(0.03, 0.15, {"sphere": 1, "capsule": 2, "cylinder": 2}.get(kind, 3)))
    return f'<geom type="{kind}" size="{size}" pos="{draw.point(0.2)}" {draw.turned("euler")} density="{draw.uniform(300, 3000)}"/>'


def _tendon(draw: _Draw, joints: list[str]) -> str:
    if len(joints) < 2 or draw.chance(0.5):
        return ""
    wound = "".join(f'<joint joint="{joint}" coef="{draw.uniform(-1, 1)}"/>' for joint in joints[:2])
    own = draw.some(0.5, f'stiffness="{draw.uniform(1, 20)}" springlength="{draw.uniform(0, 0.3)}"')
    own += draw.some(0.5, f' damping="{draw.uniform(0.1, 1)}"') + draw.some(0.4, f' actuatorfrcrange="{draw.range(2)}"')
    return f'<tendon><fixed name="belt" {own}>{wound}</fixed></tendon>'


def random_urdf(rng: np.random.Generator) -> str:
    """Return the text of a random URDF file, which MuJoCo does not change as it reads it."""
    draw = _Draw(rng)
    text, count = "", int(rng.integers(2, 6))
    for k in range(1, count):
        a, b = np.sort(rng.uniform(0.01, 0.05, 2))
        moments = f'ixx="{a:.6g}" iyy="{b:.6g}" izz="{a + b - 0.3 * a:.6g}" ixy="0" ixz="0" iyz="0"'
        inertial = f'<origin xyz="{draw.point(0.2)}" {draw.turned("rpy")}/><mass value="{draw.uniform(0.2, 3)}"/><inertia {moments}/>'
        text += f'<link name="l{k}"><inertial>{inertial}</inertial></link>'
        kind = str(rng.choice(["revolute", "continuous", "prismatic", "fixed"])) if k > 1 else "continuous"
        limit = '<limit lower="-3" upper="3" effort="0" velocity="1"/>' if kind in ("revolute", "prismatic") else ""
        axis = draw.axis("slide" if kind == "prismatic" else "hinge")
        damped = draw.some(0.5, f'<dynamics damping="{draw.uniform(0.1, 1)}"/>')
        text += (
            f'<joint name="j{k}" type="{kind}"><parent link="l{rng.integers(k)}"/><child link="l{k}"/>'
            f'<origin xyz="{draw.point(0.4)}" {draw.turned("rpy")}/><axis xyz="{axis}"/>{limit}{damped}</joint>'
        )
    return f'<robot name="r"><mujoco><compiler fusestatic="false"/></mujoco><link name="l0"/>{text}</robot>'
