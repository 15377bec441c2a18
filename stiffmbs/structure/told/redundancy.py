"""What an examination for redundancy found, in sentences."""

from __future__ import annotations

from collections.abc import Iterator

from ...compile.system import System
from ...errors import AssemblyError
from ..inconsistent_constraints import Contradiction
from ..loop_equations import AGREES, CLOSED
from ..overconstraint import Overconstraint, listed, overconstraints
from ..rank_result import LoopFinding
from ..redundancy import Redundancy
from ..unproven import unproven
from .indeterminate_reactions import channel_words, directed_words

STOPS_WHERE = "stops where formulas or tables no longer hold the same"


def known_near_start(case: Overconstraint, redundancy: Redundancy) -> bool:
    """Whether equations are known to be redundant near the start alone."""
    rows = {redundancy.system.equations[row] for row in unproven(redundancy)}
    return not rows.isdisjoint(case.redundant)


def refuse_contradictions(redundancy: Redundancy) -> None:
    """Stop before a run that has no solution.

    Raises
    ------
    AssemblyError
        When equations contradict each other, or the start is a singular pose.
    """
    for sentence in (*contradiction_sentences(redundancy), *singular_sentence(redundancy)):
        raise AssemblyError(sentence)


def overconstraint_sentences(case: Overconstraint, near_start: bool = False) -> Iterator[str]:
    """An overconstraint in sentences: reason, what gives way, what is not unique, remedy.

    Parameters
    ----------
    case : Overconstraint
    near_start : bool
        Whether it is known near the start alone, as formulas or tables take part.
    """
    what_then = f"and {STOPS_WHERE}" if near_start else "which does not change the motion"
    yield f"{case.reason}; a run leaves out {_given_way(case)}, {what_then}"
    if case.undetermined:
        shared = ["what they carry together is unique"] if case.shared else []
        directed = "; ".join([*directed_words(case.undetermined), *shared])
        yield f"rigid bodies do not determine {channel_words(case.undetermined)}" + (
            f": {directed}" if directed else ""
        )
    yield case.remedy


def _given_way(case: Overconstraint) -> str:
    """The equations that a run leaves out, joint by joint."""
    of_joint: dict[str, list[str]] = {}
    for joint, equation in case.redundant:
        of_joint.setdefault(joint, []).append(equation)
    return listed([f"{joint} ({', '.join(equations)})" for joint, equations in of_joint.items()])


def contradiction_sentences(redundancy: Redundancy) -> Iterator[str]:
    """Equations that cannot hold together, a sentence for each loop that has such."""
    for finding in redundancy.findings:
        for contradiction in finding.contradictions[:1]:
            yield _contradiction_sentence(redundancy.system, finding, contradiction)


def _contradiction_sentence(system: System, finding: LoopFinding, contradiction: Contradiction) -> str:
    joint, equation = system.equations[finding.rank.equations.loop.rows[contradiction.row]]
    others = listed([name for name in contradiction.joints if name != joint])
    against = f"joint '{joint}' (equation {equation}) contradicts {others or 'itself'}"
    where = "its positions do not agree with theirs" if contradiction.level == "position" else "their velocities differ"
    return (
        f"the scene cannot be assembled: {against} at t = {contradiction.t:.6g} s, {where} (by {contradiction.gap:.3g})"
    )


def singular_sentence(redundancy: Redundancy) -> Iterator[str]:
    """That the start is a singular pose, where it is one."""
    assembled = [finding for finding in redundancy.findings if finding.rank.start.gap <= AGREES]
    bodies = [
        redundancy.system.bodies[body]
        for finding in assembled
        for body in finding.rank.equations.loop.bodies
        if finding.extra_freedoms
    ]
    if not bodies:  # a pose whose joints do not close is no pose: the search for initial values names the gap
        return
    count = redundancy.extra_freedoms
    more = "is one degree" if count == 1 else f"are {count} degrees"
    yield (
        f"the start is a singular pose of {listed(bodies)}: for an instant there {more} "
        "of freedom more than elsewhere, and neither accelerations nor reactions are determined; this is no redundancy, "
        "start a little away from there"
    )


def pose_sentences(redundancy: Redundancy) -> Iterator[str]:
    """What else makes the motion doubtful: equations that nearly repeat each other, friction without a unique load."""
    for finding in redundancy.findings:
        joints = [joint.name for joint in finding.rank.equations.loop.joints]
        if finding.nearly_dependent and not finding.contradictions:
            yield (
                f"{listed(joints)} nearly repeat each other (smallest singular value {finding.rank.least:.1g}): the motion "
                "depends on the last digits of their geometry, expected either an exact or a clear difference"
            )
        if finding.redundant and CLOSED < finding.rank.start.gap <= AGREES:
            yield (
                f"{listed(joints)} agree to {finding.rank.start.gap:.1g} of their size only: the equations left out stay open by "
                "so much"
            )
        if not finding.motion_unique:
            yield f"friction depends on reactions of {listed(joints)} that are not unique, so the motion is not unique either"


def note_sentences(redundancy: Redundancy) -> Iterator[str]:
    """What a run tells: the equations that it leaves out, and the channels without a unique value."""
    for case in overconstraints(redundancy):
        where = f"; the run {STOPS_WHERE}" if known_near_start(case, redundancy) else ""
        yield f"{case.reason}; left out: {_given_way(case)}{where}"
    if redundancy.undetermined:
        words = channel_words(redundancy.undetermined)
        yield f"rigid bodies do not determine {words}: one of many possible values is shown"
    yield from pose_sentences(redundancy)
