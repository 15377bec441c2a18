"""Overconstraints in design terms: joints involved, indeterminate reactions and remedies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..compile.system import System
from .drop_first import Redundant, rank_of
from .inconsistent_constraints import LoopRankResult
from .listed import listed
from .loops import LoopJoint
from .parameters import REDUNDANCY
from .redundancy import Redundancy
from .uniqueness import Indeterminate, indeterminate

if TYPE_CHECKING:
    from .replacements import Choice


class Overconstraint(NamedTuple):
    """Joints that together constrain a motion more than once.

    - `joints`: all joints involved.
    - `redundant`: joint and name of the dropped equations.
    - `indeterminate`: reactions that are not unique because of it.
    - `shared`: true if all joints connect the same bodies, so that their total reaction is unique.
    - `remedies`: joints to remove, all of one tuple together, for every reaction to be unique.
    - `elastic`: joints to make elastic, all together, for their stiffness to determine every reaction.
    - `replacements`: joints and kinds that release just the redundant constraints: each joint alone, or a few
      together.
    - `reason`, `remedy`: each a sentence without a full stop.
    """

    joints: tuple[str, ...]
    redundant: tuple[tuple[str, str], ...]
    indeterminate: tuple[Indeterminate, ...]
    shared: bool
    remedies: tuple[tuple[str, ...], ...]
    elastic: tuple[str, ...]
    replacements: tuple[Choice, ...]
    reason: str
    remedy: str


def overconstraints(redundancy: Redundancy) -> Iterator[Overconstraint]:
    """Yield the independent overconstraints of a system."""
    blocks = [(rank_result, block) for rank_result in redundancy.rank_results for block in _blocks(rank_result)]
    what = "all reactions" if len(blocks) == 1 else "these reactions"
    for rank_result, block in blocks:
        yield _overconstraint(redundancy.system, rank_result, block, what)


def _blocks(rank_result: LoopRankResult) -> list[list[Redundant]]:
    """Group redundant equations with common rows or the same joints."""
    joint_of = rank_result.rank.equations.loop.joint_of
    blocks: list[tuple[set[int], list[Redundant]]] = []
    for part in rank_result.redundant:
        blocks.append(({part.row, *part.others}, [part]))
        while other := _alike(blocks, joint_of):
            blocks.remove(other)
            rows, members = blocks.pop()
            blocks.append((rows | other[0], [*other[1], *members]))
    return [members for _, members in blocks]


def _alike(
    blocks: list[tuple[set[int], list[Redundant]]], joint_of: list[str]
) -> tuple[set[int], list[Redundant]] | None:
    """Return a block that belongs to the last one."""
    *others, (rows, _) = blocks
    joints = {joint_of[row] for row in rows}
    return next((o for o in others if o[0] & rows or {joint_of[row] for row in o[0]} == joints), None)


def _overconstraint(system: System, rank_result: LoopRankResult, block: list[Redundant], what: str) -> Overconstraint:
    """Describe one block; `what`: reactions that a remedy makes unique."""
    loop = rank_result.rank.equations.loop
    joint_of = [joint for joint in loop.joints for _ in joint.rows]
    rows = sorted({row for part in block for row in (part.row, *part.others)})
    joints = list({joint_of[row].name: joint_of[row] for row in rows}.values())
    driven = list(dict.fromkeys(joint_of[row].name for row in rows if rank_result.driven[row]))
    names = {joint.name for joint in joints}
    spaces = [(pose, _of_block(rank_result, space, block)) for pose, space in rank_result.rank.null_spaces]
    remedies = list(_remedies(rank_result, spaces[-1][1], joints))
    shares = [spaces[-1][1][rows] for rows in _own_rows(rank_result, joints)]
    elastic = elastic_joints(joints, shares)
    chosen: list[Choice] = []
    if system.of_body.dimensions == 3:
        from .replacements import replacements  # not imported for planar models

        chosen = replacements(rank_result.rank.equations, spaces, joints)
    parts = indeterminate(rank_result.rank, spaces)
    channels = {name for part in rank_result.indeterminate if part.element in names for name in part.channels}
    return Overconstraint(
        joints=tuple(joint.name for joint in joints),
        redundant=tuple(system.equations[row] for row in sorted(loop.rows[part.row] for part in block)),
        indeterminate=tuple(parts),
        shared=_between_the_same(joints) and {name for part in parts for name in part.channels} == channels,
        remedies=tuple(tuple(joint.name for joint in some) for some in remedies),
        elastic=tuple(joint.name for joint in elastic),
        replacements=tuple(chosen),
        reason=_reason(system, joints, driven, len(block)),
        remedy=_remedy(remedies, elastic, chosen, what),
    )


def _reason(system: System, joints: list[LoopJoint], driven: list[str], count: int) -> str:
    names, equations = [joint.name for joint in joints], f"{count} redundant equation{'s' if count > 1 else ''}"
    bodies = sorted({body for joint in joints for body in joint.bodies})
    held = listed([system.bodies[body] for body in bodies])
    if len(driven) > 1:
        return f"over-driven: {listed(driven)} prescribe the same motion of {held} ({equations})"
    if driven:
        return (
            f"over-driven: {driven[0]} prescribes a motion of {held} that other joints already prescribe ({equations})"
        )
    if _between_the_same(joints):
        relative = "relative " if len(bodies) > 1 else ""
        return f"{listed(names)} constrain the same {relative}motion of {held} ({equations})"
    return f"{listed(names)} overconstrain loops of {held} ({equations})"


def _between_the_same(joints: list[LoopJoint]) -> bool:
    return all(set(joint.bodies) == set(joints[0].bodies) for joint in joints)


def _of_block(rank_result: LoopRankResult, space: np.ndarray, block: list[Redundant]) -> np.ndarray:
    """Return the null vectors of some redundant equations, one for each."""
    chosen = [rank_result.redundant.index(part) for part in block]
    one_each: np.ndarray = space @ np.linalg.inv(space[[part.row for part in rank_result.redundant]])
    return one_each[:, chosen]


def _remedies(
    rank_result: LoopRankResult, space: np.ndarray, joints: list[LoopJoint]
) -> Iterator[tuple[LoopJoint, ...]]:
    """Yield each joint that is a remedy alone, or else a few that are together."""
    count = space.shape[1]
    own = _own_rows(rank_result, joints)
    alone = [joint for joint, rows in zip(joints, own, strict=True) if rank_of(space[rows]) == count]
    if alone:
        yield from ((joint,) for joint in alone)
        return
    yield tuple(joints[k] for k in _together(space, own, [bool(joint.element.elastic) for joint in joints]))


def _together(space: np.ndarray, own: list[np.ndarray], elastic: list[bool]) -> Iterator[int]:
    """Yield joints whose rows span a null space, each with the largest part of the remainder."""
    place = np.full((len(own), max(map(len, own))), len(space))
    for k, rows in enumerate(own):
        place[k, : len(rows)] = rows
    rest = np.vstack([space, np.zeros(space.shape[1])])  # the last row pads joints with fewer rows
    while True:
        grams = rest[place] @ rest[place].transpose(0, 2, 1)
        gains = np.sum(np.linalg.eigvalsh(grams) > REDUNDANCY.takes_part**2, axis=1).tolist()
        best = max(range(len(own)), key=lambda k: (gains[k], elastic[k], k))
        if not gains[best]:
            return
        yield best
        _, sizes, directions = np.linalg.svd(rest[own[best]], full_matrices=False)
        taken = directions[sizes > REDUNDANCY.takes_part]
        rest = rest - (rest @ taken.T) @ taken


def _own_rows(rank_result: LoopRankResult, joints: list[LoopJoint]) -> list[np.ndarray]:
    joint_of = rank_result.rank.equations.loop.joint_of
    return [np.array([row for row, name in enumerate(joint_of) if name == joint.name]) for joint in joints]


def _remedy(
    remedies: list[tuple[LoopJoint, ...]], elastic: tuple[LoopJoint, ...], chosen: list[Choice], what: str
) -> str:
    """Return a sentence on changes that make reactions statically determinate or determined by stiffness."""
    options = [f"with {kinds}" for kinds in _replaced(chosen)]
    left_out = [joint.name for joint, *more in remedies if not more and not joint.element.elastic]
    if left_out or not (options or elastic):
        options.append(f"without {_one_of(left_out) if left_out else listed([joint.name for joint in remedies[0]])}")
    sentences = [f"{', or '.join(options)}, {what} are statically determinate"] if options else []
    if elastic:
        sentences.append(
            f"with {_elastic_words(elastic)}, stiffness determines {what}; a single elastic joint parallel to rigid ones "
            "carries no load"
        )
    return "; ".join(sentences)


def _elastic_words(elastic: Sequence[LoopJoint]) -> str:
    """Describe bushings and springs in place of joints."""
    of_kind: dict[str, list[str]] = {}
    for joint in elastic:
        of_kind.setdefault(joint.element.elastic, []).append(joint.name)
    return " and ".join(f"{kind}s in place of {_all_of(names)}" for kind, names in of_kind.items())


def _all_of(names: Sequence[str]) -> str:
    return f"both {listed(names)}" if len(names) == 2 else f"all of {listed(names)}" if len(names) > 2 else names[0]


def _replaced(chosen: list[Choice]) -> Iterator[str]:
    """Yield the joints and their replacement kinds in words, by kind."""
    if chosen and len(chosen[0]) > 1:
        yield listed([f"{_a(kind)} in place of {joint}" for joint, kind in chosen[0]])
        return
    kinds: dict[str, list[str]] = {}
    for ((joint, kind),) in chosen:
        kinds.setdefault(kind, []).append(joint)
    yield from (f"{_a(kind)} in place of {_one_of(joints)}" for kind, joints in kinds.items())


def _a(kind: str) -> str:
    return f"a{'n' if kind[0] in 'aeio' else ''} {kind} joint"


def _one_of(names: Sequence[str]) -> str:
    return f"one of {listed(names)}" if len(names) > 1 else names[0]


def elastic_joints(joints: Sequence[LoopJoint], shares: Sequence[np.ndarray]) -> tuple[LoopJoint, ...]:
    """Return the joints to make elastic together; of those on one load path, if there are others, the last.

    `joints`: all joints involved. `shares` of shape (rows, redundant equations): the rows of each joint in the null
    space N of J^T. Returns empty if too few joints can be replaced by elastic elements.
    """
    usable = [
        k for k, share in enumerate(shares) if joints[k].element.elastic and np.abs(share).max() > REDUNDANCY.takes_part
    ]
    for chosen in (_last_of_each_path(joints, usable), usable):
        if _decides([shares[k] for k in chosen]):
            return tuple(joints[k] for k in chosen)
    return ()


def _decides(shares: Sequence[np.ndarray]) -> bool:
    """Return True if stiffness determines the reactions: w is determined without any one of the elastic joints."""
    if len(shares) < 2:
        return False
    count = shares[0].shape[1]
    return all(rank_of(np.vstack([*shares[:k], *shares[k + 1 :]])) == count for k in range(len(shares)))


def _last_of_each_path(joints: Sequence[LoopJoint], usable: Sequence[int]) -> list[int]:
    """Return the last joint of each load path through bodies with two joints."""
    path = list(range(len(joints)))
    for body in {body for joint in joints for body in joint.bodies}:
        around = [k for k, joint in enumerate(joints) if body in joint.bodies]
        if len(around) == 2:
            one, other = (path[k] for k in around)
            path = [one if p == other else p for p in path]
    return list({path[k]: k for k in usable}.values())
