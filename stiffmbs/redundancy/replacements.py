"""Replacement of spatial joints by kinds that transmit less, so that every reaction is unique.

A joint of a weaker kind between the same markers releases components of its reaction. If as many are released as
equations are redundant, independently along the null space of J^T, all reactions are unique and no freedom is added.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..compile.placed_markers import marker_axes
from .loop_equations import LoopEquations, Pose
from .loops import LoopJoint
from .parameters import REDUNDANCY
from .uniqueness import changes_of

IDEAL = ("spherical", "cylindrical", "revolute", "prismatic", "planar")
"""Kinds of real joints; the others are tried if these are not sufficient."""

Choice = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class _Option:
    """Replacement of a joint by a weaker kind.

    `let_go` of shape (components, null vectors): released components along each null vector, at each pose. `count`:
    number of released equations.
    """

    joint: str
    kind: str
    let_go: list[np.ndarray]
    count: int


def replacements(
    equations: LoopEquations, spaces: Sequence[tuple[Pose, np.ndarray]], joints: Sequence[LoopJoint]
) -> list[Choice]:
    """Return the joints and replacement kinds: each joint that suffices alone, else a few together, else none.

    `spaces`: poses, and null vectors of the scaled J^T there for the redundant equations. `joints`: joints to choose
    from; the last is changed first.
    """
    count, last = spaces[0][1].shape[1], joints[-REDUNDANCY.most_joints :]
    seen = [_in_marker_axes(equations, pose, space, last) for pose, space in spaces]
    if not any(seen):  # a planar model
        return []
    known = transmitted()
    options = [
        list(_options(joint, [wrenches.get(joint.name) for wrenches in seen], known)) for joint in reversed(last)
    ]
    for kinds in (IDEAL, (*IDEAL, *(kind for kind in known if kind not in IDEAL))):
        usable = [[option for kind in kinds for option in of_joint if option.kind == kind] for of_joint in options]
        alone = [(option,) for of_joint in usable for option in of_joint if _does((option,), count)]
        if alone:
            return [_named(choice) for choice in {c[0].joint: c for c in reversed(alone)}.values()]
        together = next(_together([part for part in usable if part], count), None)
        if together:
            return [_named(together)]
    return []


def _in_marker_axes(
    equations: LoopEquations, pose: Pose, space: np.ndarray, joints: Sequence[LoopJoint]
) -> dict[str, np.ndarray]:
    """Return the joints' reactions along each null vector in the axes of their markers j, shape (6, vectors)."""
    change, found = changes_of(equations, pose, space), {}
    for joint in joints:
        axes = marker_axes(equations.state.system, joint.name, "j", equations.state.q)
        if axes is not None:
            wrench = np.array([change[f"{joint.name}.{name}"] for name in COMPONENTS])
            found[joint.name] = np.vstack([axes.T @ wrench[:3], axes.T @ wrench[3:]])
    return found


def _options(
    joint: LoopJoint, wrenches: Sequence[np.ndarray | None], known: Mapping[str, tuple[str, ...]]
) -> Iterator[_Option]:
    transmits = joint.element.transmits
    for kind, kept in known.items():
        weaker = set(kept) < set(transmits) or (kept == transmits and len(kept) < len(joint.rows))
        if weaker and all(wrench is not None for wrench in wrenches):
            rows = [k for k, name in enumerate(COMPONENTS) if name not in kept]
            let_go = [wrench[rows] for wrench in wrenches if wrench is not None]
            yield _Option(joint.name, kind, let_go, len(joint.rows) - len(kept))


def _does(choice: Sequence[_Option], count: int) -> bool:
    """Return True if options release as many components as equations are redundant, all of them independent."""
    return sum(option.count for option in choice) == count and _independent(choice)


def _independent(choice: Sequence[_Option]) -> bool:
    count = sum(option.count for option in choice)
    for parts in zip(*(option.let_go for option in choice), strict=True):
        values = np.linalg.svd(np.vstack(parts), compute_uv=False)
        if count > len(values) or values[count - 1] < REDUNDANCY.independent_component:
            return False
    return True


def _together(options: Sequence[Sequence[_Option]], count: int) -> Iterator[tuple[_Option, ...]]:
    """Yield sufficient choices of options of several joints."""
    trials = 0
    for size in range(2, min(REDUNDANCY.most_changed, len(options)) + 1):
        for joints in itertools.combinations(options, size):
            for choice in itertools.product(*joints):
                if sum(option.count for option in choice) == count:
                    trials += 1
                    if trials > REDUNDANCY.most_trials:
                        return
                    if _independent(choice):
                        yield choice


def _named(choice: Sequence[_Option]) -> Choice:
    return tuple((option.joint, option.kind) for option in choice)


COMPONENTS = ("fx", "fy", "fz", "tx", "ty", "tz")


def transmitted() -> dict[str, tuple[str, ...]]:
    """Return the components that each kind of joint in space transmits (`Joint.transmits`), if declared.

    Kinds that transmit only forces come first, those with most components leading, as point guides are easier to make
    than orientation guides.
    """
    from ..elements.element import Joint
    from ..elements.spatial.spatial_kinds import JOINTS

    found = [(kind, joint.transmits) for kind, joint in JOINTS.items() if issubclass(joint, Joint) and joint.transmits]
    return dict(sorted(found, key=lambda item: (any(name[0] == "t" for name in item[1]), -len(item[1]))))
