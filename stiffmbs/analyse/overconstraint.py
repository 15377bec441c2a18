"""Redundant equations in a designer's words: what is held twice, what that leaves open, and what would settle it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..compile.system import System
from ..describe.element import JointName
from ..describe.marker import Marker
from .finding import LoopFinding
from .give_way import TAKES_PART, Redundant
from .loops import LoopJoint
from .redundancy import Redundancy
from .uniqueness import Undetermined

MOST_NAMES = 6


@dataclass(frozen=True)
class Overconstraint:
    """Joints that together hold something more than once.

    Attributes
    ----------
    joints : tuple of str
        All that take part.
    redundant : tuple of (str, str)
        Joint and name of the equations that give way.
    undetermined : tuple of Undetermined
        The reactions that have no unique value because of it.
    remedies : tuple of tuple of str
        Joints that would have to be left out or made elastic, all of one tuple together, for every reaction to be unique.
    reason, remedy : str
        Each a sentence without a full stop.
    """

    joints: tuple[str, ...]
    redundant: tuple[tuple[str, str], ...]
    undetermined: tuple[Undetermined, ...]
    remedies: tuple[tuple[str, ...], ...]
    reason: str
    remedy: str


def overconstraints(redundancy: Redundancy) -> Iterator[Overconstraint]:
    """What is held more than once in a system, independent cases apart."""
    for finding in redundancy.findings:
        for block in _blocks(finding):
            yield _overconstraint(redundancy.system, finding, block)


def directions(parts: Sequence[Undetermined]) -> str:
    """The directions in which forces are undetermined, in words; empty where they have none that stays."""
    found = [
        f"of {part.element} at {math.degrees(part.direction):.4g} deg of {part.axes}"
        for part in parts
        if part.axes is not None and part.direction is not None
    ]
    return f"forces only in the directions {listed(found)}, across them they are unique" if found else ""


def listed(names: Sequence[str]) -> str:
    """Names in a row, the last after an 'and'; long rows are cut short."""
    if len(names) > MOST_NAMES:
        names = [*names[: MOST_NAMES - 1], f"{len(names) - MOST_NAMES + 1} more"]
    return f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else "".join(names)


def _blocks(finding: LoopFinding) -> list[list[Redundant]]:
    """Redundant equations that are repeated by common rows, or among the same joints, together."""
    joint_of = [joint.name for joint in finding.rank.equations.loop.joints for _ in joint.rows]
    blocks: list[tuple[set[int], list[Redundant]]] = []
    for part in finding.redundant:
        rows, members = {part.row, *part.others}, [part]
        joints = {joint_of[row] for row in rows}
        for other in [block for block in blocks if block[0] & rows or {joint_of[row] for row in block[0]} == joints]:
            blocks.remove(other)
            rows, members = rows | other[0], [*other[1], *members]
        blocks.append((rows, members))
    return [members for _, members in blocks]


def _overconstraint(system: System, finding: LoopFinding, block: list[Redundant]) -> Overconstraint:
    loop = finding.rank.equations.loop
    joint_of = [joint for joint in loop.joints for _ in joint.rows]
    rows = sorted({row for part in block for row in (part.row, *part.others)})
    joints = list({joint_of[row].name: joint_of[row] for row in rows}.values())
    driven = list(dict.fromkeys(joint_of[row].name for row in rows if finding.driven[row]))
    names = {joint.name for joint in loop.joints} - {joint.name for joint in joints}
    remedies = list(_remedies(finding, block, joints))
    return Overconstraint(
        joints=tuple(joint.name for joint in joints),
        redundant=tuple(sorted(system.equations[loop.rows[part.row]] for part in block)),
        undetermined=tuple(part for part in finding.undetermined if part.element not in names),
        remedies=tuple(tuple(joint.name for joint in some) for some in remedies),
        reason=_reason(system, joints, driven, len(block)),
        remedy=_remedy(remedies),
    )


def _reason(system: System, joints: list[LoopJoint], driven: list[str], count: int) -> str:
    names, equations = [joint.name for joint in joints], f"{count} equation{'s' if count > 1 else ''} too many"
    bodies = sorted({body for joint in joints for body in joint.bodies})
    held = listed([system.bodies[body] for body in bodies])
    if len(driven) > 1:
        return f"over-driven: {listed(driven)} prescribe the same motion of {held} ({equations})"
    if driven:
        return f"over-driven: {driven[0]} prescribes a motion of {held} that other joints hold already ({equations})"
    if all(set(joint.bodies) == set(joints[0].bodies) for joint in joints):
        against = " against each other" if len(bodies) > 1 else ""
        return f"{held} {'are' if against else 'is'} guided twice{against}: {listed(names)} hold the same ({equations})"
    return f"{held} form loops that hold themselves: {listed(names)} close them more often than needed ({equations})"


def _remedies(finding: LoopFinding, block: list[Redundant], joints: list[LoopJoint]) -> Iterator[tuple[LoopJoint, ...]]:
    """Each joint that alone would settle it; where there is none, a few that do together."""
    chosen = [finding.redundant.index(part) for part in block]
    space = finding.rank.null_spaces[-1][1]
    space = (space @ np.linalg.inv(space[[part.row for part in finding.redundant]]))[:, chosen]
    first = {joint.name: row for row, joint in _first_rows(finding)}
    own = [np.arange(first[joint.name], first[joint.name] + len(joint.rows)) for joint in joints]
    alone = [joint for joint, rows in zip(joints, own, strict=True) if _rank(space[rows]) == len(block)]
    if alone:
        yield from ((joint,) for joint in alone)
        return
    together: list[int] = []
    while (reached := _rank(space[_stacked(own, together)])) < len(block):
        gains = [_rank(space[_stacked(own, [*together, k])]) - reached for k in range(len(joints))]
        together.append(max(range(len(joints)), key=lambda k: (gains[k], _elastic(joints[k]), k)))
    yield tuple(joints[k] for k in together)


def _first_rows(finding: LoopFinding) -> Iterator[tuple[int, LoopJoint]]:
    first = 0
    for joint in finding.rank.equations.loop.joints:
        yield first, joint
        first += len(joint.rows)


def _stacked(own: list[np.ndarray], joints: list[int]) -> np.ndarray:
    return np.concatenate([np.empty(0, dtype=np.int64), *(own[k] for k in joints)])


def _rank(rows: np.ndarray) -> int:
    values = np.linalg.svd(rows, compute_uv=False)
    return int(np.sum(values > TAKES_PART)) if values.size else 0


def _remedy(remedies: list[tuple[LoopJoint, ...]]) -> str:
    if len(remedies) == 1 and len(remedies[0]) > 1:
        return f"bushings in place of {listed([joint.name for joint in remedies[0]])} make all reactions unique"
    elastic = [joint.name for (joint,) in remedies if _elastic(joint)]
    others = [joint.name for (joint,) in remedies if not _elastic(joint)]
    choices = (("a bushing in place of", elastic), ("leaving out", others))
    ways = [f"{way} {_one_of(names)}" for way, names in choices if names]
    return f"{' or '.join(ways)} makes all reactions unique"


def _one_of(names: Sequence[str]) -> str:
    return f"one of {listed(names)}" if len(names) > 1 else names[0]


def _elastic(joint: LoopJoint) -> bool:
    """Whether a bushing can take the joint's place: it holds two markers."""
    return len(list(joint.element.parts(Marker))) == 2 and not next(joint.element.parts(JointName), None)
