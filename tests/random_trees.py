"""Random trees of rigid bodies as files of robots."""

import numpy as np


def _numbers(values):
    return " ".join(f"{x:.6f}" for x in values)


def _turn(rng):
    p = rng.normal(size=4)
    return p / np.linalg.norm(p)


def _inertia_mjcf(rng):
    centre, inertia = rng.uniform(-0.2, 0.2, 3), rng.uniform(0.09, 0.12, 3)
    return centre, (
        f'<inertial pos="{_numbers(centre)}" quat="{_numbers(_turn(rng))}" mass="{rng.uniform(0.5, 2):.6f}" '
        f'diaginertia="{_numbers(inertia)}"/>'
    )


def _subtree(rng, k, n, parents):
    """The body k with its joint and its children."""
    kind = rng.choice(["hinge", "slide"], p=[0.75, 0.25])
    joint = (
        f'<joint name="joint{k}" type="{kind}" axis="{_numbers(rng.normal(size=3))}" pos="{_numbers(rng.uniform(-0.1, 0.1, 3))}" '
        f'damping="{rng.uniform(0, 0.5):.6f}"/>'
    )
    inner = "".join(_subtree(rng, other, n, parents) for other in range(n) if parents[other] == k)
    return (
        f'<body name="link{k}" pos="{_numbers(rng.uniform(-0.5, 0.5, 3))}" quat="{_numbers(_turn(rng))}">{joint}'
        f"{_inertia_mjcf(rng)[1]}{inner}</body>"
    )


def _parents(rng, n):
    return [-1, *(int(rng.integers(-1 if k % 4 == 0 else 0, k)) for k in range(1, n))]


def tree_in_mjcf(rng, n=6):
    """Hinges and slides, one for each body."""
    parents = _parents(rng, n)
    bodies = "".join(_subtree(rng, k, n, parents) for k in range(n) if parents[k] < 0)
    return f"<mujoco><worldbody>{bodies}</worldbody></mujoco>"


def free_tree_in_mjcf(rng, n=4):
    """A free base with a tree on it, and the centre of mass of the base in its axes."""
    parents = _parents(rng, n)
    bodies = "".join(_subtree(rng, k, n, parents) for k in range(n) if parents[k] < 0)
    centre, inertial = _inertia_mjcf(rng)
    return f'<mujoco><worldbody><body name="base"><freejoint/>{inertial}{bodies}</body></worldbody></mujoco>', np.round(
        centre, 6
    )


def tree_in_urdf(rng, n=6):
    """Continuous and prismatic joints."""
    parents = _parents(rng, n)
    text = ['<robot name="tree"><link name="world"/>']
    for k, parent in enumerate(parents):
        inertia = rng.uniform(0.09, 0.12, 3)
        text.append(
            f'<link name="link{k}"><inertial><origin xyz="{_numbers(rng.uniform(-0.2, 0.2, 3))}" rpy="{_numbers(rng.normal(size=3))}"/>'
            f'<mass value="{rng.uniform(0.5, 2):.6f}"/><inertia ixx="{inertia[0]:.6f}" ixy="0.001" ixz="0" iyy="{inertia[1]:.6f}" '
            f'iyz="-0.002" izz="{inertia[2]:.6f}"/></inertial></link>'
        )
        kind = "revolute" if rng.random() < 0.75 else "prismatic"
        axis = rng.normal(size=3)
        text.append(
            f'<joint name="joint{k}" type="{kind}"><parent link="{"world" if parent < 0 else f"link{parent}"}"/><child link="link{k}"/>'
            f'<origin xyz="{_numbers(rng.uniform(-0.5, 0.5, 3))}" rpy="{_numbers(rng.normal(size=3))}"/>'
            f'<axis xyz="{_numbers(axis / np.linalg.norm(axis))}"/><limit lower="-9" upper="9" effort="1e6" velocity="1e6"/></joint>'
        )
    return "".join([*text, "</robot>"])
