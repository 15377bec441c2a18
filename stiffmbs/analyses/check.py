"""Check of a model without a run: degrees of freedom, redundant constraints, reactions without a unique value."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Unpack

from ..compile.active_dampers import active_damper_notes
from ..compile.machine.routines import on_drafts
from ..compile.system import System
from ..compile.written_values import table_notes
from ..dynamics.initial import InitialValues
from ..dynamics.moves import Move
from ..errors import AssemblyError, SolverError
from ..methods import NotebookMethods
from ..model.scene import Scene, notes_of
from ..model.settings import RunSettings, Settings, takes_settings
from ..redundancy.idle_freedoms import IdleFreedom, idle_freedoms
from ..redundancy.listed import listed
from ..redundancy.messages.presolve_report import presolve_sentences, unconnected_notes, unknowns
from ..redundancy.messages.redundancy import (
    inconsistency_sentences,
    known_near_start,
    overconstraint_sentences,
    pose_notes,
    singular_sentence,
)
from ..redundancy.opposed_actuators import opposed_notes
from ..redundancy.overconstraint import Overconstraint, overconstraints
from ..solve.subsystems import Subsystem, presolved
from ..tuning import in_use
from .job import Examined, Runnable, assembled, data_of, examined
from .start_forces import start_force_notes

MOST_MOVES = 50
"""Number of moved bodies that a message names at most; `Report.moved` lists all."""


@dataclass(frozen=True, repr=False)
class Report(NotebookMethods):
    """Result of `check`.

    Attributes
    ----------
    name : str
    degrees_of_freedom : int
        n_u - rank.
    equations, rank : int
        Number of constraint equations, and of those that are independent in general.
    redundant : tuple of (str, str)
        Joint and name of each equation that a run leaves out.
    not_unique : tuple of str
        Reaction channels without a unique value.
    overconstraints : tuple of Overconstraint
        Redundant constraints, with reasons and remedies.
    inconsistencies : tuple of str
        Sentences on equations that no motion satisfies.
    extra_freedoms : int
        Degrees of freedom at the start beyond those in general: more than 0 at a singular pose.
    unknowns : tuple of (int, int)
        Number of unknowns of the formulation SI2, before and after presolve.
    presolve : tuple of str
        Sentences on the parts that presolve removes from the solution.
    moved : tuple of Move
        Changes of the described bodies by assembly.
    messages : tuple of str
        All other messages, one sentence each.
    sound : bool
        True if nothing prevents a run with unique reactions.
    """

    name: str
    degrees_of_freedom: int
    equations: int
    rank: int
    redundant: tuple[tuple[str, str], ...]
    not_unique: tuple[str, ...]
    overconstraints: tuple[Overconstraint, ...]
    inconsistencies: tuple[str, ...]
    extra_freedoms: int
    unknowns: tuple[int, int]
    presolve: tuple[str, ...]
    moved: tuple[Move, ...]
    messages: tuple[str, ...]
    sound: bool

    def as_dict(self, scene: str) -> dict[str, object]:
        """Return the content of ``stiffmbs check --json``; `scene` is the file or name of the scene."""
        return {
            "scene": scene,
            "degrees_of_freedom": self.degrees_of_freedom,
            "equations": self.equations,
            "rank": self.rank,
            "redundant": [{"joint": joint, "equation": equation} for joint, equation in self.redundant],
            "not_unique": list(self.not_unique),
            "unknowns": {"before": self.unknowns[0], "after": self.unknowns[1]},
            "messages": [*self.messages, *(f"presolve: {sentence}" for sentence in self.presolve)],
        }

    def __repr__(self) -> str:
        return f"<Report {str(self).splitlines()[0]}; {'sound' if self.sound else 'problems'}>"

    def __str__(self) -> str:
        count = self.degrees_of_freedom
        freedoms = f"{count} degree{'s' if count != 1 else ''} of freedom"
        head = (
            f"{self.name or 'model'}: {freedoms}, {self.equations} equations of rank "
            f"{self.rank}, {self.unknowns[0]} unknowns"
        )
        presolve = [f"presolve: {sentence}" for sentence in self.presolve]
        return "\n".join([head, *presolve, *(f"- {message}" for message in self.messages or ("no problems found",))])


@takes_settings
@on_drafts()
def check(model: Runnable, settings: RunSettings | None = None, **changes: Unpack[Settings]) -> Report:
    """Examine a model: degrees of freedom, redundancy, uniqueness of reactions, singular poses, contradictions.

    Parameters
    ----------
    model : Model, Scene, str or Path
        A model, a scene, or a scene's file.
    settings : RunSettings, optional
        Settings of the run; by default those of the scene.
    **changes
        Fields of the settings to change.

    Returns
    -------
    Report

    Raises
    ------
    InputError
        If the model or a setting is wrong.
    """
    data = data_of(model)
    if isinstance(data, Scene) and data.stages:
        return _of_stages(data, [check(stage, settings, **changes) for stage in data.stage_scenes])
    found = examined(data, settings, **changes)
    with in_use(found.settings.tuning):
        return _of_run(found)


def _of_run(found: Examined) -> Report:
    redundancy, system = found.redundancy, found.redundancy.system
    cases = tuple(overconstraints(redundancy))
    against = tuple(inconsistency_sentences(redundancy))
    problems = [*against]
    for case in () if against else cases:
        problems += overconstraint_sentences(case, known_near_start(case, redundancy))
    problems += [*singular_sentence(redundancy), *pose_notes(redundancy)]
    dynamics, subsystems, free = found.dynamics(), tuple[Subsystem, ...](), list[IdleFreedom]()
    start: InitialValues | None = None
    if not against:
        try:
            start = assembled(found.data, dynamics, found.grid.start)
            free = idle_freedoms(dynamics, found.grid.start)
            subsystems = presolved(found.data, dynamics, start, found.grid, found.settings, lambda decide: decide())
            problems += [start.position_sentence(MOST_MOVES)] if start.moved_far else []
        except (AssemblyError, SolverError) as error:
            problems += [] if redundancy.extra_freedoms else [str(error)]
    return Report(
        name=found.data.name, degrees_of_freedom=redundancy.degrees_of_freedom, equations=system.n_c,
        rank=redundancy.rank, redundant=redundancy.redundant, not_unique=redundancy.not_unique, overconstraints=cases,
        inconsistencies=against, extra_freedoms=redundancy.extra_freedoms,
        unknowns=unknowns(system, subsystems, dynamics), presolve=tuple(presolve_sentences(system, subsystems, dynamics)),
        moved=start.moved if start else (),
        messages=(*problems, *_assembly_sentence(start), *_freedom_sentences(found, system, free),
                  *(start_force_notes(found.data, dynamics, start, found.grid.start) if start else ()),
                  *(opposed_notes(system, found.data, start.q, found.grid) if start else ()), *notes_of(found.data), *table_notes(found.data),
                  *active_damper_notes(found.data)), sound=not problems,
    )  # fmt: skip


def _of_stages(scene: Scene, reports: Sequence[Report]) -> Report:
    """Return the report on the first stage, with the messages on the others."""
    first = reports[0]
    messages = [
        f"stage {k} of {len(reports)}: {message}"
        for k, report in enumerate(reports, start=1)
        for message in (f"{report.degrees_of_freedom} degrees of freedom", *report.messages)
        if k == 1 or message not in first.messages
    ]
    sound = all(report.sound for report in reports)
    return replace(first, name=scene.name, messages=tuple(messages), sound=sound)


def _assembly_sentence(start: InitialValues | None) -> Iterator[str]:
    """Yield a sentence on the changes by assembly if they are not a problem."""
    if start and not start.moved_far and (sentence := start.position_sentence(MOST_MOVES)):
        yield sentence


def _freedom_sentences(found: Examined, system: System, free: Sequence[IdleFreedom]) -> Iterator[str]:
    if found.redundancy.degrees_of_freedom == 0:
        yield "joints and drives prescribe every coordinate: 0 degrees of freedom, the motion is kinematic"
    for freedom in free:
        body, motion, between = freedom.body, freedom.motion, listed(freedom.between)
        if freedom.held_by:
            prevent = "prevents" if len(freedom.held_by) == 1 else "prevent"
            yield f"the joints let {body} {motion} by itself between {between}; {listed(freedom.held_by)} {prevent} it"
        else:
            yield f"{body} can {motion} by itself between {between}, which moves no other body"
    yield from unconnected_notes(system)
