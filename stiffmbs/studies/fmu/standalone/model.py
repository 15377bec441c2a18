"""Model of an FMU without Python: image of the tables of a scene, its variables, and the refusal of what the FMU cannot compute."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ....analyses.job import Job, prepare
from ....compile.inputs.of_time import expressions_of, given_to
from ....compile.machine.image import Image, image_of
from ....compile.machine.layout import Addressed
from ....compile.machine.object_code import SHORT
from ....compile.machine.routines import together
from ....compile.reactions import reactions
from ....dynamics.dynamics import OUTPUT_POINTS, Dynamics, OutputRows
from ....dynamics.held_inputs import AffineNumber
from ....dynamics.native.layouts import JUDGED
from ....errors import InputError
from ....model.files.written_scene import WrittenScene
from ....model.read_scene import read_changed
from ....model.scene import Scene
from ....notes import Note, NoteKind, Severity
from ....reading.did_you_mean import did_you_mean
from ....results.channels import channels_of_model, motion_channels, state_channels
from ....results.joint_angles import joint_angles
from ....run_checks.tables import may_refuse
from ....solve.auto import begins_implicit
from ....solve.explicit.integration import Integration
from ....solve.explicit.native.parameters import CONTROL
from ....solve.explicit.scheme import ADVANCE
from ....solve.explicit.schemes import DOP853
from ....solve.explicit.stable_step import rates_at
from ....solve.settings import changed, traits_of
from ...case_solver import CaseSolver, Task, written_scene
from ...input_numbers import TRIED, InputNumbers
from ...simulation import OWN_INPUTS

CONSISTENT_RATES, EVENT_FUNCTIONS, VIOLATION = together(
    "stiffmbs.solve.explicit.native.state_space",
    SHORT,
    consistent_rates="int64(float64, float64*, float64*, float64*, int64*)",
    event_functions="void(float64, float64*, float64*, int64*, int64*)",
    violation="float64(float64, float64*, int64*)",
)


ENTRIES: Mapping[str, Addressed] = {
    "ADVANCE": ADVANCE, "OUTPUT_POINTS": OUTPUT_POINTS, "CONSISTENT_RATES": CONSISTENT_RATES, "EVENT_FUNCTIONS": EVENT_FUNCTIONS,
}  # fmt: skip
"""Routines that the C code of the FMU calls, by their names there."""
OF_REQUEST = "of_request_{}"
"""Name of the output of a request, by its number."""
TOTAL = "energy.total"
STIFF = NoteKind(
    "fmu-stiff",
    "the scene is stiff: stability limits the steps of co-simulation to about {step:.2g} s, which takes longer than the implicit steps of a run",
    "if that is too slow, use model exchange with a solver for stiff equations, or the FMU with Python",
    Severity.REMARK,
)


@dataclass(frozen=True)
class ExportedModel:
    """Scene that an FMU solves by `dop853`, ready to be written.

    - `work`: integration from the start of the scene, whose tables the image contains.
    - `image`: copy of all tables.
    - `states`: name of each continuous state, empty without a channel, by its place in (q, u). All others are algebraic.
    - `places`: places in the row of outputs, by channel. `others`: channels that Python computes.
    - `inputs`: values of inputs at the start by name, then those of `parameters`. `numbers`: numbers of forces that depend on them.
    - `breakpoints`: times at which the integration restarts, s, and their distance `aside`.
    - `notes`: sentences for the user.
    """

    job: Job
    work: Integration
    image: Image
    states: Mapping[int, str]
    places: Mapping[str, int]
    others: tuple[str, ...]
    inputs: Mapping[str, float]
    parameters: tuple[str, ...]
    numbers: tuple[AffineNumber, ...]
    breakpoints: np.ndarray
    aside: float
    notes: tuple[Note, ...]

    @property
    def dynamics(self) -> Dynamics:
        """Dynamics of the whole model, without the presolve."""
        return self.job.dynamics

    @property
    def depends_on_time(self) -> bool:
        """True if a formula or a table is one of time, whose breakpoints are known for the run of the scene alone."""
        system = self.dynamics.system
        given = given_to(system)
        elements = (element for group in system.groups if group.has_inputs for element in group.elements)
        return any(True for element in elements for _ in expressions_of(element, given))

    @property
    def first_output(self) -> int:
        """Value reference of the first number of the row; those of the state begin at 0."""
        return self.dynamics.system.n_q + self.dynamics.system.n_u

    @property
    def first_derivative(self) -> int:
        """Value reference of the first derivative."""
        return self.first_output + self.places[TOTAL] + 1

    @property
    def first_input(self) -> int:
        """Value reference of the first input."""
        return self.first_derivative + self.first_output

    @property
    def time(self) -> int:
        """Value reference of time; those of the event functions follow."""
        return self.first_input + len(self.inputs)

    def chosen(self, names: tuple[str, ...]) -> dict[str, int]:
        """Return the places of outputs in the row; raises InputError for one that an FMU without Python cannot compute."""
        for name in names:
            if name in self.inputs:
                raise InputError(f"found the output '{name}', which is an input of the FMU, expected another")
            if name in self.others:
                raise InputError(refused(f"the output '{name}' is computed by Python; choose others by --channel"))
            if name not in self.places:
                near = did_you_mean(name, self.places)
                raise InputError(
                    f"found no channel '{name}'{near}, expected one such as {', '.join(list(self.places)[:12])}"
                )
        return {name: self.places[name] for name in names}


def refused(reason: str) -> str:
    """Return the sentence of a refusal."""
    return f"an FMU without Python is not possible for this scene: {reason}, or write the FMU with Python (without --native)"


def exported_model(scene: Scene, outputs: Sequence[str] = ()) -> ExportedModel:
    """Return the model of a scene for an FMU with some outputs, by default all requests.

    Raises InputError for what only an FMU with Python computes.
    """
    given = {name: float(value) for name, value in scene.inputs.items() if isinstance(value, float | int)}
    written, of_requests = _with_requests(scene, written_scene(scene), outputs or scene.outputs())
    solver = _solver(written, given)
    scene = solver.scene([*given.values()])
    job = prepare(scene, changed(scene.run, {"presolve": False}))
    dynamics, grid = job.dynamics, job.grid
    _refuse(job)
    numbers = _numbers(job, solver, given)
    parameters, of_parameters = _parameters(job, written, given, numbers)
    numbers += of_parameters
    notes = _notes(job)
    state = dynamics.state
    state.q[:], state.u[:], state.lam[:] = job.start.q, job.start.u, job.start.lam
    work = Integration.of(DOP853, dynamics, job.start, grid, job.settings, capacity=1)  # no rows are read
    features = dynamics.input_features(grid.start, grid.end)
    work.step_bound.follow(features)
    dynamics.forget_pivots()
    work.watch.watch_for(np.zeros(work.watch.n_event_functions))
    image = image_of([work.table, dynamics.table, work.watch.table])
    states, places, others = _variables(dynamics)
    own = {channel: name for name, channel in of_requests.items()}
    places = {own.get(name, name): place for name, place in places.items() if name not in given}
    requests = tuple(name for name in scene.outputs() if name not in places)
    return ExportedModel(
        job,
        work,
        image,
        states,
        places,
        (*others, *requests),
        given | parameters,
        tuple(parameters),
        numbers,
        features.breakpoints,
        grid.aside,
        notes,
    )


def _refuse(job: Job) -> None:
    """Raise an InputError if the model needs Python within a step, or a method that the FMU does not have."""
    dynamics, settings, system = job.dynamics, job.settings, job.dynamics.system
    reason = ""
    if system.has_functions:
        reason = "it calls Python functions; replace them by formulas"
    elif system.sampled.any():
        reason = "it has sampled states; replace them by continuous ones"
    elif settings.solver == "kinematic":
        reason = "its solver 'kinematic' is no integrator; choose 'projected'"
    elif settings.solver == "projected" and traits_of(settings).fixed_steps:
        reason = "its scheme has fixed steps, and the FMU has the adaptive steps of dop853; choose that scheme"
    elif may_refuse(system):
        reason = "a table has 'beyond: error', which is checked by Python; choose 'hold' or 'extend'"
    elif dynamics.input_end(job.grid.start, job.grid.end) is not None:
        reason = "a formula of time has no value at the end of the run; end the run before"
    elif _steps_of_a_run(job) * (system.n_q + system.n_u) > CONTROL.too_many_steps:
        reason = f"it is stiff, and explicit steps of {_stable_step(job):.2g} s would take more than ten minutes; reduce its largest stiffness"
    if reason:
        raise InputError(refused(reason))


def _stable_step(job: Job) -> float:
    """Return the longest step, s, that stability allows at the start; infinite without vibrations and damping."""
    rate = rates_at(job.dynamics, job.grid.start, job.start.q, job.start.u).fastest
    return DOP853.stability / rate if rate > 0 else np.inf


def _steps_of_a_run(job: Job) -> float:
    """Return the number of explicit steps that stability requires for the run of the scene."""
    return (job.grid.end - job.grid.start) / _stable_step(job)


def _notes(job: Job) -> tuple[Note, ...]:
    """Return a note if the steps of the FMU are far shorter than those of an implicit solver would be."""
    if job.settings.solver == "projected" or not begins_implicit(job.dynamics, job.start, job.grid, job.settings):
        return ()
    return (STIFF(step=_stable_step(job)),)


def _numbers(job: Job, solver: CaseSolver, inputs: Mapping[str, float]) -> tuple[AffineNumber, ...]:
    """Return the numbers of forces that follow from the inputs; raises InputError if they are no affine functions of one each."""
    if not inputs:
        return ()
    found = InputNumbers(job, solver, inputs)
    if not found.affine:
        raise InputError(refused("its forces are not affine functions of one input each; rewrite their formulas"))
    if found.of_time and _move_features(job, found, inputs):
        raise InputError(
            refused("its inputs change the times at which formulas of time have jumps or bends; rewrite their formulas")
        )
    return found.held.numbers


def _solver(written: WrittenScene, inputs: Mapping[str, float], *parameters: str) -> CaseSolver:
    """Return the solver of a scene with its inputs, and some parameters, as varied values."""
    return CaseSolver(Task(written, (*(f"{OWN_INPUTS}.{name}" for name in inputs), *parameters), {}, ()))


def _parameters(
    job: Job, written: WrittenScene, inputs: Mapping[str, float], of_inputs: tuple[AffineNumber, ...]
) -> tuple[dict[str, float], tuple[AffineNumber, ...]]:
    """Return the parameters that may be changed, and the numbers of forces that are affine functions of one of them.

    All others are fixed: those that change bodies, joints, the start, or times of jumps. So are those of which a number is no
    affine function, or of which it is one of several. `of_inputs`: numbers that depend on inputs.
    """
    scene, found = job.data, dict[str, float]()
    if not isinstance(scene, Scene) or scene.start != "described" or scene.at_start:
        return {}, ()
    numbers: list[AffineNumber] = []
    taken = {(id(each.numbers), each.place) for each in of_inputs}
    for name, value in scene.parameters.items():
        solver = _solver(written, {}, name)
        if name in inputs or not isinstance(value, float | int) or not solver.is_affine(0):
            continue
        of_parameter = replace(job, data=solver.scene([float(value)]))  # the forces that a change reads again differ
        try:
            own = InputNumbers(of_parameter, solver, {name: float(value)})
        except InputError:  # it changes more than numbers
            continue
        places = {(id(each.numbers), each.place) for each in own.held.numbers}
        if not own.affine or not places or places & taken:
            continue
        if own.of_time and _move_features(of_parameter, own, {name: float(value)}):
            continue
        taken |= places
        numbers += [each._replace(input=len(inputs) + len(found)) for each in own.held.numbers]
        found[name] = float(value)
    return found, tuple(numbers)


def _move_features(job: Job, numbers: InputNumbers, inputs: Mapping[str, float]) -> bool:
    """Return True if the features of formulas of time differ between some values of an input."""

    def features(values: Mapping[str, float]) -> list[list[float]]:
        numbers.set(values)
        found = job.dynamics.input_features(job.grid.start, job.grid.end)
        return [part.tolist() for part in (found.breakpoints, found.starts, found.longest, found.at_ends)]

    first = features(inputs)
    differ = any(features({**inputs, name: value}) != first for name in inputs for value in TRIED)
    numbers.set(inputs)
    return differ


def _variables(dynamics: Dynamics) -> tuple[dict[int, str], dict[str, int], tuple[str, ...]]:
    """Return the channel of each continuous state, the place of each channel in the row of outputs, and all other channels.

    Two rows of random numbers tell which channels are a number of the row; all others are computed in Python.
    """
    system = dynamics.system
    widths = (system.n_q, system.n_u, system.n_u, system.n_c, system.n_values("output"), len(JUDGED))
    numbers = np.random.default_rng(1).uniform(10.0, 1000.0, (2, sum(widths)))  # angles far apart are unwrapped
    parts = np.split(numbers, np.cumsum(widths)[:-1], axis=1)
    judged = dict(zip(JUDGED, parts[5].T, strict=True))
    q, u, acceleration, lam, values = parts[:5]
    rows = OutputRows(np.zeros(2), q, u, acceleration, lam, values, status=0, **judged)
    channels = motion_channels(system, rows.q, rows.u, rows.acceleration)
    channels |= state_channels(system, rows.q, rows.values) | reactions(system, rows.values)
    if (angles := joint_angles(system)) is not None:
        channels |= angles.continuous(rows)
    channels |= channels_of_model(rows)
    places = {tuple(column): place for place, column in enumerate(numbers.T.tolist())}
    found = {
        name: places[tuple(values.tolist())] for name, values in channels.items() if tuple(values.tolist()) in places
    }
    named = {place: name for name, place in found.items()}
    states = np.setdiff1d(np.arange(system.n_q + system.n_u), system.algebraic_coordinates).tolist()
    found[TOTAL] = sum(widths)
    return {place: named.get(place, "") for place in states}, found, tuple(channels.keys() - found)


def _with_requests(
    scene: Scene, written: WrittenScene, outputs: Collection[str]
) -> tuple[WrittenScene, dict[str, str]]:
    """Return the source of a scene with a transfer function of 1 for each request among `outputs`, and its channel by request.

    It is not possible for formulas of reactions, accelerations, energies or other requests, and for those of parts. A formula of time
    bounds the steps, so that only those of outputs have one.
    """
    section, found = written.content.get("requests"), {}
    for number, (name, output) in enumerate(scene.outputs().items()):
        if not isinstance(section, dict) or name.partition(".")[0] not in section or name not in outputs:
            continue
        channel = OF_REQUEST.format(number)
        change = f"states.{channel}", {"numerator": [1], "denominator": [1], "input": output.text}
        extended = replace(written, changes=(*written.changes, change))
        try:
            read_changed(extended, ())
        except InputError:
            continue
        written, found[name] = extended, channel
    return written, found
