"""Messages on redundancy."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence

from ...errors import AssemblyError
from ...notes import Note, NoteKind, Severity
from ..listed import listed
from ..overconstraint import Overconstraint, overconstraints
from ..parameters import REDUNDANCY
from ..redundancy import Redundancy
from ..uniqueness import Direction, Indeterminate, unproven

STOPS_WHERE = "stops where formulas or tables make these equations independent"
OVERCONSTRAINED = NoteKind("redundant-equations", "{reason}; left out: {equations}{where}", severity=Severity.REMARK)
NOT_UNIQUE = NoteKind(
    "reactions-not-unique", "rigid bodies do not determine {channels}: the values shown are one possible solution"
)
DERIVATIVES = NoteKind(
    "derivatives-not-unique",
    "rigid bodies do not determine {channels}: the derivatives are those of one possible solution",
)
NEARLY_DEPENDENT = NoteKind(
    "nearly-dependent-equations",
    "the equations of {joints} are nearly dependent (smallest singular value {least:.1g}), and the motion depends on the "
    "last digits of the geometry; {remedy}",
    "expected equations that are exactly dependent or clearly independent",
)
DISAGREE = NoteKind(
    "redundant-equations-disagree",
    "the redundant equations of {joints} agree only to {gap:.1g} of the size: the equations left out keep this error",
)
NO_UNIQUE_MOTION = NoteKind(
    "motion-not-unique",
    "friction, a formula or the rate of a state depends on reactions of {joints} that are not unique, so "
    "the motion is not unique either",
)


def known_near_start(case: Overconstraint, redundancy: Redundancy) -> bool:
    """Return True if equations are known to be redundant near the start only."""
    rows = {redundancy.system.equations[row] for row in unproven(redundancy)}
    return not rows.isdisjoint(case.redundant)


def refuse_inconsistencies(redundancy: Redundancy) -> None:
    """Refuse a run without a solution.

    Raises AssemblyError when equations contradict each other, or the start is a singular pose.
    """
    for sentence in (*inconsistency_sentences(redundancy), *singular_sentence(redundancy)):
        raise AssemblyError(sentence)


def overconstraint_sentences(case: Overconstraint, near_start: bool = False) -> Iterator[str]:
    """Yield sentences on an overconstraint: reason, dropped equations, indeterminate reactions, remedy.

    `near_start`: true if it is known near the start only, as formulas or tables are involved.
    """
    what_then = f"and {STOPS_WHERE}" if near_start else "which does not change the motion"
    yield f"{case.reason}; a run leaves out {_omitted(case)}, {what_then}"
    if case.indeterminate:
        shared = ["their sum is unique"] if case.shared else []
        directed = "; ".join([*directed_words(case.indeterminate), *shared])
        yield f"rigid bodies do not determine {channel_words(case.indeterminate)}" + (
            f": {directed}" if directed else ""
        )
    yield case.remedy


def _omitted(case: Overconstraint) -> str:
    """List the dropped equations by joint."""
    of_joint: dict[str, list[str]] = {}
    for joint, equation in case.redundant:
        of_joint.setdefault(joint, []).append(equation)
    return listed([f"{joint} ({', '.join(equations)})" for joint, equations in of_joint.items()])


def inconsistency_sentences(redundancy: Redundancy) -> Iterator[str]:
    """Yield a sentence on contradicting equations for each loop that has some."""
    for rank_result in redundancy.rank_results:
        for inconsistency in rank_result.inconsistencies[:1]:
            joint, equation = redundancy.system.equations[rank_result.rank.equations.loop.rows[inconsistency.row]]
            others = listed([name for name in inconsistency.joints if name != joint])
            differ = "positions" if inconsistency.level == "position" else "velocities"
            yield (
                f"the scene cannot be assembled: joint '{joint}' (equation {equation}) contradicts {others or 'itself'} "
                f"at t = {inconsistency.t:.6g} s, {differ} differ (by {inconsistency.gap})"
            )


def singular_sentence(redundancy: Redundancy) -> Iterator[str]:
    """Yield a sentence if the start is a singular pose."""
    assembled = [
        rank_result for rank_result in redundancy.rank_results if rank_result.rank.start.gap <= REDUNDANCY.agrees
    ]
    bodies = [
        redundancy.system.bodies[body]
        for rank_result in assembled
        for body in rank_result.rank.equations.loop.bodies
        if rank_result.extra_freedoms
    ]
    if not bodies:  # initial value assembly names the gap of joints that do not close
        return
    count = redundancy.extra_freedoms
    more = "is one degree" if count == 1 else f"are {count} degrees"
    yield (
        f"the start is a singular pose of {listed(bodies)}: there {more} "
        "of freedom more than in other poses, and accelerations and reactions are not determined; "
        "start in a pose nearby"
    )


def derivative_notes(redundancy: Redundancy, channels: Collection[str]) -> Iterator[Note]:
    """Yield the notes on derivatives of channels: those of reactions without a unique value, and of a motion without."""
    if found := [name for name in redundancy.not_unique if name in channels]:
        yield DERIVATIVES(found[0], channels=listed(found))
    yield from (note for note in pose_notes(redundancy) if note.kind == NO_UNIQUE_MOTION.name)


def pose_notes(redundancy: Redundancy) -> Iterator[Note]:
    """Yield notes on nearly dependent equations and on friction with indeterminate loads."""
    for rank_result in redundancy.rank_results:
        names = [joint.name for joint in rank_result.rank.equations.loop.joints]
        first, joints = names[0], listed(names)
        if rank_result.nearly_dependent and not rank_result.inconsistencies:
            yield NEARLY_DEPENDENT(first, joints=joints, least=rank_result.rank.least)
        if rank_result.redundant and REDUNDANCY.closed < rank_result.rank.start.gap <= REDUNDANCY.agrees:
            yield DISAGREE(first, joints=joints, gap=rank_result.rank.start.gap)
        if not rank_result.motion_unique:
            yield NO_UNIQUE_MOTION(first, joints=joints)


def redundancy_notes(redundancy: Redundancy) -> Iterator[Note]:
    """Yield the notes of a run: dropped equations, and channels without a unique value."""
    for case in overconstraints(redundancy):
        where = f"; the run {STOPS_WHERE}" if known_near_start(case, redundancy) else ""
        yield OVERCONSTRAINED(case.redundant[0][0], reason=case.reason, equations=_omitted(case), where=where)
    if redundancy.indeterminate:
        words = channel_words(redundancy.indeterminate)
        yield NOT_UNIQUE(redundancy.indeterminate[0].element, channels=words)
    yield from pose_notes(redundancy)


def channel_words(parts: Sequence[Indeterminate]) -> str:
    """List the components, with elements that have the same ones together: ``fz and tx of lower and upper``."""
    alike: dict[tuple[str, ...], list[str]] = {}
    for part in parts:
        components = tuple(name.rpartition(".")[2] for name in part.channels)
        alike.setdefault(components, []).append(part.element)
    return "; ".join(f"{listed(components)} of {listed(elements)}" for components, elements in alike.items())


def directed_words(parts: Sequence[Indeterminate]) -> Iterator[str]:
    """Yield the constant directions of indeterminate forces and torques."""
    in_plane = [
        f"of {part.element} at {round(math.degrees(math.atan2(*direction.vector[::-1])), 4) % 180:.4g} deg of {direction.axes}"
        for part in parts
        for direction in part.directions if len(direction.vector) == 2
    ]  # fmt: skip
    if in_plane:
        yield f"only forces in the directions {listed(in_plane)}; perpendicular to them they are unique"
    alike: dict[Direction, list[str]] = {}
    for part in parts:
        for direction in part.directions:
            if len(direction.vector) == 3 and not _shown_by_channels(part, direction):
                alike.setdefault(direction, []).append(part.element)
    for direction, elements in alike.items():
        where = f"{'perpendicular to' if direction.across else 'along'} {_axis(direction.vector)} of {direction.axes}"
        other = "along it" if direction.across else "perpendicular to it"
        yield f"only {direction.quantity}s of {listed(elements)} {where}; {other} they are unique"


def _axis(vector: Sequence[float]) -> str:
    if max(abs(part) for part in vector) == 1.0:
        return "xyz"[[abs(part) for part in vector].index(1.0)]
    return f"({', '.join(f'{part:.4g}' for part in vector)})"


def _shown_by_channels(part: Indeterminate, direction: Direction) -> bool:
    """Return True if the components without a unique value are as few as the directions."""
    components = [name for name in part.channels if name.rpartition(".")[2].startswith(direction.quantity[0])]
    return len(components) <= (2 if direction.across else 1)
