"""Mass matrix and dynamics of arms in joint coordinates."""

from __future__ import annotations

from pathlib import Path

from ..joint_space import JointSpaceCalls

SCENES = Path(__file__).parents[1] / "scenes"
BENCHMARKS = (
    JointSpaceCalls("arm_in_joint_space", SCENES / "arm.xml"),
    JointSpaceCalls("seven_joints_in_joint_space", SCENES / "seven_joints.xml"),
)
