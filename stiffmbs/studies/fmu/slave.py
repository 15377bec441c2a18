"""PythonFMU slave: runs a scene between communication points inside an FMU.

It is imported by the FMU's script, in the Python of the program that runs the FMU.
"""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

from ...analyses.load_scene import load_scene
from ...errors import StiffmbsError
from ..simulation import Simulation, simulation
from .build import ABOUT, SCENE


def hold(names: dict[str, Any]) -> None:
    """Take an extra reference to the globals of an FMU's script.

    PythonFMU 0.7 executes the script at each instantiation, and then releases a reference to its globals that it does not own.
    Without the extra reference the globals would be freed while the script is in use.
    """
    with suppress(AttributeError, ImportError, OSError):
        import ctypes

        ctypes.pythonapi.Py_IncRef(ctypes.py_object(names))


class SceneSlave(Fmi2Slave):  # type: ignore[misc]
    """FMU slave with the inputs, parameters and channels of a scene as variables."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        folder = Path(self.resources)
        about = json.loads((folder / ABOUT).read_text(encoding="utf-8"))
        self.description, self.version = about["description"], about["version"]
        self.default_experiment = DefaultExperiment(*(about[name] for name in ("start", "stop", "step", "tolerance")))
        self._path, self._rtol = folder / SCENE, float(about["tolerance"])
        self._inputs: dict[str, float] = dict(about["inputs"])
        self._parameters: dict[str, float] = dict(about["parameters"])
        self._start: float = about["start"]
        self._tolerance: float | None = None
        self._simulation: Simulation | None = None
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
        structure = root.find("ModelStructure")
        outputs = root.findall("ModelStructure/Outputs/Unknown")
        if structure is not None and outputs:
            unknowns = SubElement(structure, "InitialUnknowns")
            for output in outputs:
                SubElement(unknowns, "Unknown", {"index": output.attrib["index"]})
        return root

    def _register(self, values: dict[str, float], causality: Any, variability: Any) -> None:
        """Register variables that another program sets."""
        for name, value in values.items():

            def put(number: float, name: str = name) -> None:
                values[name] = number
                self._channels = None
                if causality != Fmi2Causality.input:
                    self._simulation = None

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

    def _running(self) -> Simulation:
        """Return the simulation, of the scene with the values that were set."""
        if self._simulation is None:
            rtol = min(self._tolerance or self._rtol, self._rtol)
            values = {f"parameters.{name}": value for name, value in self._parameters.items()}
            values |= {f"inputs.{name}": value for name, value in self._inputs.items()}
            values |= {"run.start": self._start} | ({"run.rtol": rtol} if self._tolerance else {})
            self._simulation = simulation(
                load_scene(self._path, [(path, repr(value)) for path, value in values.items()])
            )
        return self._simulation

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Advance to the next communication point; inputs are constant over the step.

        The integrator keeps its history while the inputs do not change.
        """
        self._channels = None
        try:
            self._running().step(step_size, self._inputs)
        except StiffmbsError as error:
            self.log(str(error))
            return False
        return True
