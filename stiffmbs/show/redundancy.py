"""What an examination for redundancy found, in sentences."""

from __future__ import annotations

from collections.abc import Iterator

from ..analyse.contradictions import Contradiction
from ..analyse.finding import LoopFinding
from ..analyse.overconstraint import Overconstraint, directions, listed, overconstraints
from ..analyse.redundancy import Redundancy
from ..compile.system import System
from ..errors import AssemblyError


def refuse_contradictions(redundancy: Redundancy) -> None:
    """Stop before a run that has no solution.

    Raises
    ------
    AssemblyError
        When equations contradict each other, or the start is a singular pose.
    """
    for sentence in (*contradiction_sentences(redundancy), *singular_sentence(redundancy)):
        raise AssemblyError(sentence)


def overconstraint_sentences(case: Overconstraint) -> Iterator[str]:
    """An overconstraint in sentences: reason, what gives way, what is not unique, remedy."""
    gone = listed([f"{joint} ({equation})" for joint, equation in case.redundant])
    yield f"{case.reason}; a run leaves out {gone}, which does not change the motion"
    channels = [name for part in case.undetermined for name in part.channels]
    if channels:
        directed = directions(case.undetermined)
        yield f"rigid bodies do not determine {', '.join(channels)}" + (f": {directed}" if directed else "")
    yield case.remedy


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
    return f"the scene cannot be assembled: {against} at t = {contradiction.t:.6g} s, {where}"


def singular_sentence(redundancy: Redundancy) -> Iterator[str]:
    """That the start is a singular pose, where it is one."""
    if not redundancy.extra_freedoms:
        return
    bodies = [
        redundancy.system.bodies[body]
        for finding in redundancy.findings
        for body in finding.rank.equations.loop.bodies
        if finding.extra_freedoms
    ]
    yield (
        f"the start is a singular pose of {listed(bodies)}: for an instant there are {redundancy.extra_freedoms} degrees "
        "of freedom more than elsewhere, and neither accelerations nor reactions are determined; this is no redundancy, "
        "start a little away from there"
    )


def pose_sentences(redundancy: Redundancy) -> Iterator[str]:
    """What else makes the motion doubtful: equations that nearly repeat each other, friction without a unique load."""
    for finding in redundancy.findings:
        joints = [joint.name for joint in finding.rank.equations.loop.joints]
        if finding.nearly_dependent:
            yield (
                f"{listed(joints)} nearly repeat each other (smallest singular value {finding.rank.least:.1g}): the motion "
                "hangs on the last digits of their geometry, expected either an exact or a clear difference"
            )
        if not finding.motion_unique:
            yield f"friction hangs on reactions of {listed(joints)} that are not unique, so the motion is not unique either"


def note_sentences(redundancy: Redundancy) -> Iterator[str]:
    """What a run tells: the equations that it leaves out, and the channels without a unique value."""
    for case in overconstraints(redundancy):
        gone = listed([f"{joint} ({equation})" for joint, equation in case.redundant])
        yield f"{case.reason}; left out: {gone}"
    if redundancy.not_unique:
        yield f"rigid bodies do not determine {', '.join(redundancy.not_unique)}: one of many possible values is shown"
    yield from pose_sentences(redundancy)
