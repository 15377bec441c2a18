"""Simulation in real time."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Unpack

from ..analyses.job import Runnable, data_of, settings_of
from ..compile.bodies import PLANE, SPACE
from ..compile.machine.routines import fully_compiled
from ..errors import InputError, StiffmbsError, refuse_text
from ..model.settings import DEFAULT_POINTS, RunSettings, Settings, takes_settings
from ..results.solution import Solution
from ..solve.settings import changed, output_grid, traits_of
from ..studies.simulation import simulation_of
from ..tuning import in_use
from .accuracy import Accuracy, accuracy
from .exchange import Alone
from .loop import MEASURED, NANO, Loop, Record, take_steps, warm_up
from .recorded import RecordedSimulation
from .report import RealTime
from .udp import UdpExchange

DEFAULT_SOLVER = {"solver": "projected", "scheme": "extrapolated_euler"}
"""Settings of the steps if neither a solver nor a scheme is given."""
OVER_UDP = "not determined, as inputs came over UDP and no other run has them"
TOO_SHORT = "not determined, as no output time was reached"
"""Reasons for no comparison with a run with error control."""


@takes_settings
@fully_compiled()
def realtime(
    model: Runnable,
    settings: RunSettings | None = None,
    inputs: Mapping[str, float] | None = None,
    channels: Sequence[str] = (),
    paced: bool = True,
    udp: str = "",
    network: bool = False,
    tell: Callable[[str], None] | None = None,
    **changes: Unpack[Settings],
) -> RealTime:
    """Take steps of fixed length in real time, and report their times and their accuracy.

    Parameters
    ----------
    model : Model, Scene, str or Path
    settings : RunSettings, optional
        Settings of the run with error control, from which the duration and the output interval of the steps are taken; by
        default those of the scene.
    inputs : mapping of str to float, optional
        Inputs in addition to those of the scene, as for `stiffmbs.simulation`.
    channels : sequence of str, optional
        Outputs that are read after each step. Over UDP, by default the requests of the scene, or the positions of its
        bodies if it has none.
    paced : bool, optional
        Begin each step when it is due by the clock. Otherwise a step begins when the last one ends; over UDP, when a
        packet comes.
    udp : str, optional
        HOST:PORT at which packets of inputs are received, and from which outputs are sent to their sender. Port 0 is any
        free port.
    network : bool, optional
        Allow a host that is not on the loopback interface: packets are not authenticated.
    tell : callable, optional
        Called with a sentence on the progress.
    **changes
        Settings of the steps: `step`, s, and `solver` and `scheme`, by default `projected` with `extrapolated_euler`.
        Other fields are changed in both runs.

    Returns
    -------
    RealTime

    Raises
    ------
    InputError
        If the model, a setting, an input, a channel or the address is invalid.
    AssemblyError
        If no consistent start is found.

    Examples
    --------
    >>> found = stiffmbs.realtime("examples/half_car.yaml", step=1e-3, duration=1.0)
    >>> print(found)
    """
    refuse_text("channels", channels, "channels")
    data = data_of(model)
    common = {name: value for name, value in changes.items() if name not in ("step", "solver", "scheme")}
    own = settings_of(data, settings, common)
    stepped = steps_of(own, changes)
    sim = simulation_of(RecordedSimulation, data, inputs, stepped, {})
    chosen = _known(sim, channels) or (_usual_outputs(sim) if udp else ())
    count = max(round(own.duration / stepped.step), 1)
    loop = Loop(stepped.step, count, chosen, paced)
    say = tell or (lambda _: None)
    if not udp:
        return _reported(sim, loop, own, None, say)
    exchange = UdpExchange(udp, tuple(sim.inputs), chosen, in_turns=not paced, network=network)
    try:
        return _reported(sim, loop, own, exchange, say)
    finally:
        exchange.close()


def steps_of(own: RunSettings, changes: Settings) -> RunSettings:
    """Return the settings of the steps, from those of a run with error control and changes.

    Raises InputError if there is no step, or if a setting is invalid.
    """
    chosen: dict[str, Any] = {name: changes[name] for name in ("step", "solver", "scheme") if name in changes}  # type: ignore[literal-required]
    if not {"solver", "scheme"} & chosen.keys() and not traits_of(own).fixed_steps:
        chosen |= DEFAULT_SOLVER
    if "scheme" in chosen:
        chosen = {"solver": "projected", **chosen}
    elif "solver" in chosen:
        chosen["scheme"] = None
    if "step" not in chosen and not traits_of(own).fixed_steps:
        raise InputError("step: found none, expected the time step, such as step=1e-3 or --step 1ms")
    found = changed(own, chosen)
    if found.step > found.duration:
        raise InputError(f"step: found {found.step:g} s, expected at most the duration of {found.duration:g} s")
    return found


def _known(sim: RecordedSimulation, channels: Sequence[str]) -> tuple[str, ...]:
    """Return channels; raise an InputError if there is no such channel."""
    for name in channels:
        sim[name]
    return tuple(channels)


def _usual_outputs(sim: RecordedSimulation) -> tuple[str, ...]:
    """Return the requests of a scene, or the positions of its bodies if it has none."""
    requests = tuple(sim.data.outputs())
    kind = SPACE if sim.data.dimensions == 3 else PLANE
    return requests or tuple(f"{body}.{part}" for body in sim.data.bodies for part in kind.positions)


def _reported(
    sim: RecordedSimulation, loop: Loop, own: RunSettings, exchange: UdpExchange | None, say: Callable[[str], None]
) -> RealTime:
    """Take the steps, and return their report."""
    with in_use(sim.settings.tuning):
        warm_up(sim, loop)
    record = Record(sim, loop.steps, _steps_between_outputs(own, loop))
    if exchange is not None:
        say(f"waiting for the first packet at {exchange.address}")
        exchange.wait()
    say("taking steps")
    with in_use(sim.settings.tuning), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RuntimeWarning)
        ending = take_steps(sim, loop, exchange or Alone(), record)
    solution = None if exchange else sim.solution(*record.solved(), ending.outcome, ending.message)
    return RealTime(
        name=sim.data.name, solver=traits_of(sim.settings).name, step=loop.dt, start=float(record.t[0]), requested=loop.steps,
        spent=record.spent[: record.done] * NANO, measured=MEASURED,
        late=record.late[: record.done] * NANO if loop.paced else None,
        outcome=ending.outcome, message=ending.message, channels=tuple(loop.channels),
        exchanged=exchange.exchanged() if exchange else None, accuracy=_accuracy(sim, solution, own, say), solution=solution,
        notes=(*sim.notes(), *(str(each.message) for each in caught if each.category is RuntimeWarning)),
    )  # fmt: skip


def _steps_between_outputs(own: RunSettings, loop: Loop) -> int:
    """Return the number of steps between output times."""
    times = output_grid(own).times
    interval = own.duration / DEFAULT_POINTS if times is None else times[1] - times[0]
    return min(max(round(interval / loop.dt), 1), loop.steps)


def _accuracy(
    sim: RecordedSimulation, solution: Solution | None, own: RunSettings, say: Callable[[str], None]
) -> Accuracy:
    """Return the differences of the steps from a run with error control."""
    if solution is None:
        return Accuracy.unknown(OVER_UDP)
    if len(solution.time) < 2:
        return Accuracy.unknown(TOO_SHORT)
    say("solving with error control")
    try:
        return accuracy(solution, sim.data, own)
    except StiffmbsError as error:
        return Accuracy.unknown(f"not determined, as the run with error control failed: {error}")
