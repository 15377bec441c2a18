"""PythonFMU slave: runs a scene between communication points inside an FMU.

It is imported by the FMU's script, in the Python of the program that runs the FMU.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Slave, Fmi2Variability, Real
from pythonfmu.enums import Fmi2Status

from ...analyses.load_scene import load_scene
from ...errors import InputError, StiffmbsError
from ...results.saved_state import SavedState
from ..simulation import Simulation, simulation
from .build import ABOUT, SCENE
from .units import unit_definitions

AT_ONE_TIME = 1e-9
"""Difference of times that the sums of a simulating program may have, relative to the time or the step."""


def hold(names: dict[str, object]) -> None:
    """Take an extra reference to the globals of an FMU's script.

    PythonFMU 0.7 executes the script at each instantiation, and then releases a reference to its globals that it does not own.
    Without the extra reference the globals would be freed while the script is in use.
    """
    with suppress(AttributeError, ImportError, OSError):
        import ctypes

        ctypes.pythonapi.Py_IncRef(ctypes.py_object(names))


class SceneSlave(Fmi2Slave):  # type: ignore[misc]
    """FMU slave with the inputs, parameters and channels of a scene as variables."""

    def __init__(self, **kwargs: object) -> None:
        super().__init__(**kwargs)
        folder = Path(self.resources)
        about = json.loads((folder / ABOUT).read_text(encoding="utf-8"))
        self.description, self.version = about["description"], about["version"]
        self.default_experiment = DefaultExperiment(*(about[name] for name in ("start", "stop", "step", "tolerance")))
        self._path, self._rtol = folder / SCENE, float(about["tolerance"])
        self._described: dict[str, float] = about["inputs"]
        self._inputs: dict[str, float] = dict(self._described)
        self._parameters: dict[str, float] = dict(about["parameters"])
        self._units: dict[str, str] = about["units"]
        self._start: float = about["start"]
        self._tolerance: float | None = None
        self._simulation: Simulation | None = None
        self._initialized = False
        self._channels: dict[str, float] | None = dict(about["outputs"])
        self._register(self._inputs, Fmi2Causality.input, Fmi2Variability.continuous)
        self._register(self._parameters, Fmi2Causality.parameter, Fmi2Variability.fixed)
        for name in about["outputs"]:
            self.register_variable(
                Real(name, causality=Fmi2Causality.output, getter=lambda name=name: self._value(name)), nested=False
            )

    def to_xml(self, model_options: dict[str, str] | None = None) -> Element:
        """Build the model description; all outputs are initial unknowns, as FMI 2.0.4 requires (section 2.2.8)."""
        root: Element = super().to_xml(model_options or {})
        for variable in root.iter("ScalarVariable"):
            if unit := self._units.get(variable.attrib["name"]):
                variable[0].set("unit", unit)
        if self._units:
            after = [part.tag for part in root].index("CoSimulation") + 1
            root.insert(after, unit_definitions(set(self._units.values())))
        structure = root.find("ModelStructure")
        outputs = root.findall("ModelStructure/Outputs/Unknown")
        if structure is not None and outputs:
            unknowns = SubElement(structure, "InitialUnknowns")
            for output in outputs:
                SubElement(unknowns, "Unknown", {"index": output.attrib["index"]})
        return root

    def _register(self, values: dict[str, float], causality: object, variability: object) -> None:
        """Register variables that another program sets."""
        for name, value in values.items():

            def put(number: float, name: str = name) -> None:
                """Set a variable; parameters keep their values after the start."""
                if causality != Fmi2Causality.input and number != values[name]:
                    if self._initialized:
                        raise self._logged(
                            InputError(
                                f"parameter '{name}': found {number:g} after the start, expected it before the start"
                            )
                        )
                    self._simulation = None
                values[name] = number
                self._channels = None

            self.register_variable(
                Real(
                    name,
                    start=value,
                    causality=causality,
                    variability=variability,
                    getter=lambda name=name: values[name],
                    setter=put,
                ),
                nested=False,
            )

    def _value(self, name: str) -> float:
        if self._channels is None:
            running = self._running()
            running.set_inputs(self._inputs)
            self._channels = running.channels
        return self._channels[name]

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Store the start time, and the tolerance, which is used if it is finer than the scene's."""
        self._start, self._tolerance = start_time, tolerance
        self._simulation = self._channels = None

    def exit_initialization_mode(self) -> None:
        """Read the scene with the parameters and inputs that were set."""
        self._simulation = self._channels = None
        self._running()
        self._initialized = True

    def _logged(self, error: StiffmbsError) -> StiffmbsError:
        """Report an error to the simulating program, and return it."""
        self.log(str(error), Fmi2Status.error)
        return error

    def _get_fmu_state(self) -> dict[str, object]:
        """Return the state for ``fmi2GetFMUstate``: the values that were set, and the time and state of the motion."""
        kept = None if self._simulation is None else self._simulation.state
        return {
            "inputs": dict(self._inputs), "parameters": dict(self._parameters), "start": self._start, "tolerance": self._tolerance,
            "initialized": self._initialized, "motion": kept and [kept.t, dict(kept.channels), dict(kept.turns)],
        }  # fmt: skip

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        """Return to a state of `_get_fmu_state`; the integrator restarts there."""
        settings = self._parameters, self._start, self._tolerance
        if state["motion"] is None or settings != (state["parameters"], state["start"], state["tolerance"]):
            self._simulation = None
        self._inputs.update(state["inputs"])
        self._parameters.update(state["parameters"])
        self._start, self._tolerance, self._initialized = state["start"], state["tolerance"], state["initialized"]
        self._channels = None
        if state["motion"] is not None:
            running = self._running(self._described)  # with the inputs of the state there may be no consistent start
            try:
                running.reset()  # so that the steps do not depend on those before
                running.set_inputs(self._inputs)
                running.load(SavedState("the state of the FMU", *state["motion"]))
            except StiffmbsError as error:
                self._simulation = None
                raise self._logged(error) from None

    def _running(self, inputs: Mapping[str, float] | None = None) -> Simulation:
        """Return the simulation, made if there is none, of the scene with other inputs or those that were set."""
        if self._simulation is None:
            rtol = min(self._tolerance or self._rtol, self._rtol)
            values = {f"parameters.{name}": value for name, value in self._parameters.items()}
            values |= {f"inputs.{name}": value for name, value in (inputs or self._inputs).items()}
            values |= {"run.start": self._start} | ({"run.rtol": rtol} if self._tolerance else {})
            try:
                self._simulation = simulation(
                    load_scene(self._path, [(path, repr(value)) for path, value in values.items()])
                )
            except StiffmbsError as error:
                raise self._logged(error) from None
        return self._simulation

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Advance to the next communication point; inputs are constant over the step.

        The integrator keeps its history while the inputs do not change.
        """
        self._channels = None
        try:
            running = self._running()
            if abs(current_time - running.t) > AT_ONE_TIME * max(abs(running.t), step_size):
                raise InputError(
                    f"step: found a step from {current_time:.9g} s, expected one from {running.t:.9g} s, where the last one ended"
                )
            running.step(step_size, self._inputs)
        except StiffmbsError as error:
            self.log(str(error), Fmi2Status.discard)
            return False
        return True
