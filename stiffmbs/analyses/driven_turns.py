"""Full turns by which position drives differ from the described angles.

A described angle and a prescribed one may differ by full turns, such as 350 and -10 degrees. The turns of the drives are
taken before elements are set up, so that assembly does not search for them in other poses. In the plane, the angles of
bodies have them, in space those of joints, from which default offsets follow.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, TypeVar

from ..compile.compile_model import compile_model
from ..compile.state import State
from ..compile.system import System
from ..elements.turns import TURN, full_turns
from ..model.current_pose import CurrentPose, read_by
from ..model.model_data import ModelData
from ..model.scene import Scene
from ..notes import Note, NoteKind, Severity
from ..reading.formula.formula import Formula
from ..reading.joint_name import JointName
from ..reading.marker import GROUND

Data = TypeVar("Data", bound=ModelData)


def turns_of_drives(data: ModelData, system: System | None, t: float) -> dict[str, int]:
    """Return the full turns to add to described angles for drives of positions at a time, s: by body, or joint in space.

    Joints that hold at the start alone count as well. `system`: of the model in the described poses, if compiled.
    """
    if data.dimensions == 3 and not any(_open_offset(joint) for joint in data.joints.values()):
        return {}  # counters find the turns
    if isinstance(data, Scene) and data.at_start and data.held_at_start and _drives(data.held_at_start):
        data, system = data.held_at_start, None
    if not (drives := _drives(data)):
        return {}
    turns = _turns_of_joints(drives, system or compile_model(data), t)
    return {name: n for name, n in (turns if data.dimensions == 3 else _of_bodies(data, turns)).items() if n}


def in_turns_of_new_drives(placed: Data, system: System, t: float) -> Data:
    """Return a model at a restart in which new drives select the turns of planar joints.

    Bodies keep theirs, and elements that acted before those in which they read the joints.

    `placed`: in the pose of a saved state. `system`: of that model, started from the state.
    """
    pose = placed._current_pose
    drives = _drives(placed) if placed.dimensions == 2 else {}  # counters find the turns in space
    drives = {name: joint for name, joint in drives.items() if pose is not None and name not in pose.acted}
    turns = {joint: n for joint, n in _turns_of_joints(drives, system, t).items() if n} if drives else {}
    if pose is None or not turns:
        return placed
    before = pose.turns_set_up(placed)
    kept = {
        read_by(reader, joint): before.get(joint, (0,))
        for reader, joint in _read_before(placed, pose)
        if joint in turns
    }
    found = placed.model_copy()
    found._current_pose = replace(
        pose,
        turns={**kept, **pose.turns, **{joint: (before.get(joint, (0,))[0] - n,) for joint, n in turns.items()}},
        angles={name: angle + TURN * turns.get(name.removesuffix(".angle"), 0) for name, angle in pose.angles.items()},
    )
    return found


def _read_before(placed: ModelData, pose: CurrentPose) -> Iterator[tuple[str, str]]:
    """Yield elements that acted before, and joints and bodies that they read; open offsets follow from the current turns instead."""
    own = {**placed.joints, **placed.forces}
    for name, element in placed.elements():
        if (name in pose.acted or name not in own) and not _open_offset(own.get(name)):
            yield from ((name, joint.joint) for _, joint in element.parts(JointName))
            for _, formula in element.parts(Formula):
                yield from ((name, owner) for owner, _ in formula.coordinates())


def _turns_of_joints(drives: Mapping[str, str], system: System, t: float) -> dict[str, int]:
    """Return the full turns to add to the angles of joints for the prescribed ones; `drives`: joints by drive."""
    state = State(system)
    state.evaluate("position", t)
    gaps = dict(zip((name for name, _ in system.equations), state.vector("position", "C"), strict=True))
    return {joint: -full_turns(gaps[drive]) for drive, joint in drives.items()}


def _of_bodies(data: ModelData, turns: Mapping[str, int]) -> dict[str, int]:
    """Return the turns of planar bodies for turns of joints; bodies beyond a driven joint turn with it, ground does not."""
    beyond: dict[str, list[tuple[str, int]]] = {}  # neighbours by body, with their turns relative to it
    for name, n in turns.items():
        joint: Any = data.joints[name]
        beyond.setdefault(joint.j.body, []).append((joint.i.body, n))
        beyond.setdefault(joint.i.body, []).append((joint.j.body, -n))
    found: dict[str, int] = {}
    for root in (GROUND, *beyond):
        reached = [root] if root in beyond and root not in found else []
        found |= dict.fromkeys(reached, 0)
        for body in reached:
            for other, n in beyond[body]:
                if other not in found:
                    found[other] = found[body] + n
                    reached.append(other)
    return found


def with_turns(data: Data, turns: Mapping[str, int]) -> Data:
    """Return a model with full turns added to described angles: of planar bodies, or of joints in space."""
    if not turns:
        return data
    if data.dimensions == 3:
        found = data.model_copy()
        found._turns_of_joints = turns
        return found
    angles = {name: data.bodies[name].angle + TURN * turns[name] for name in turns}
    turned = {name: data.bodies[name].model_copy(update={"angle": angle}) for name, angle in angles.items()}
    return data.model_copy(update={"bodies": {**data.bodies, **turned}})


OTHER_TURNS = NoteKind(
    "other-turns",
    "drives prescribe angles in other turns than the described ones; bodies start with full turns added: {turns} "
    "(same pose, other angles)",
    severity=Severity.REMARK,
)


def note_on_turns(turns: Mapping[str, int]) -> Note:
    """Return a note on the planar bodies that start in another turn than described."""
    return OTHER_TURNS(next(iter(turns)), turns=", ".join(f"{body} {n:+d}" for body, n in turns.items()))


def _drives(data: ModelData) -> dict[str, str]:
    """Return the joints whose angles are prescribed, by the names of their drives."""
    relations = {name: joint for name, joint in data.joints.items() if next(joint.parts(JointName), None)}
    if not relations:
        return {}
    from ..elements.joints.drive import Drive

    found = {}
    for name, drive in relations.items():
        if isinstance(drive, Drive) and drive.joint is not None and drive.prescribed_position is not None:
            joint = drive.joint.joint
            if drive.joint.coordinate_of(data.joints[joint]) == "angle":
                found[name] = joint
    return found


def _open_offset(joint: object) -> bool:
    from ..elements.joints.relation import OffsetConstraint

    return isinstance(joint, OffsetConstraint) and joint.offset is None
