"""Stiff multibody solver: computes motion and joint reactions from bodies, joints and forces.

Examples
--------
>>> import stiffmbs
>>> solution = stiffmbs.run("examples/cart_pendulum.yaml", rtol=1e-8)
>>> print(f"the rail carries {solution['rail.fy'].max():.1f} N at most")
the rail carries 108.8 N at most
"""

# ruff: noqa: E402, F401 Ctrl-C is to end the command without a traceback while all of this is imported and offered
from .interrupts import quiet_while_loading

quiet_while_loading()

from typing import Any

from .errors import AssemblyError, InputError, SolverError, StiffmbsError
from .loaded_later import elements_of, loaded

__version__ = "0.1.0"

_KINDS = ".elements.planar_kinds"
_LATER = {
    "AlgebraicState": ".elements.states.state", "BeamBody": ".model.beams.planar", "Body": ".elements.body", "Force": ".elements.element", "Joint": ".elements.element",
    "LinearSystem": ".elements.states.linear_system", "Marker": ".reading.marker", "Model": ".model.model", "PID": ".elements.states.linear_system",
    "PythonFunction": ".reading.python_function", "RunSettings": ".model.settings", "Scene": ".model.scene", "State": ".elements.states.state", "SampledState": ".elements.states.state",
    "SteadyMotion": ".model.settings", "Table": ".reading.table", "TransferFunction": ".elements.states.linear_system",
    "ground": ".reading.marker:GROUND", "load_scene": ".analyses.load_scene", "read_scene": ".model.read_scene", "register": ".elements.own_elements",
    "scene_schema": ".model.schema",
    "Report": ".analyses.check", "Solution": ".results.solution", "check": ".analyses.check", "compare": ".comparison.compare",
    "compare_over": ".comparison.over",
    "compile_model": ".compile.compile_model", "equilibrium": ".analyses.equilibrium", "quasi_static": ".analyses.equilibrium", "modes": ".analyses.linearised.modes", "campbell": ".analyses.linearised.campbell", "run": ".analyses.run",
    "SavedState": ".results.saved_state", "read_state": ".results.saved_state", "transfer": ".analyses.linearised.transfer",
    "verify": ".verification.verify", "sweep": ".studies.sweep", "Range": ".reading.variation", "Fit": ".studies.fit", "fit": ".studies.fit",
    "Optimum": ".studies.optimise", "optimise": ".studies.optimise",
    "Sensitivity": ".studies.sensitivities.sensitivities", "sensitivities": ".studies.sensitivities.sensitivities",
    "Handling": ".studies.handling.study", "handling": ".studies.handling.study",
    "RoadLoads": ".studies.suspension.road_loads", "road_loads": ".studies.suspension.road_loads",
    "KinematicsAndCompliance": ".studies.suspension.kinematics_and_compliance",
    "kinematics_and_compliance": ".studies.suspension.kinematics_and_compliance", "VehicleOptions": ".studies.suspension.vehicle",
    "Simulation": ".studies.simulation", "simulation": ".studies.simulation", "Simulations": ".studies.simulations", "simulations": ".studies.simulations", "follow": ".studies.follow", "Load": ".evaluation.loads", "loads": ".evaluation.loads", "in_body_axes": ".evaluation.bearing_loads", "DrivingAngle": ".evaluation.bearing_loads",
    "driving_angle": ".evaluation.bearing_loads", "Cycle": ".evaluation.cycle", "cycle": ".evaluation.cycle", "Peak": ".evaluation.peaks", "peaks": ".evaluation.peaks", "realtime": ".real_time.realtime", "RealTime": ".real_time.report",
    "JointSpace": ".studies.joint_space.space", "joint_space": ".studies.joint_space.space",
    "listed_statements": ".adams.listing", "build_fmu": ".studies.fmu.build", "differences": ".results.listings",
    "animate": ".show.drawing.animate", "draw": ".show.drawing.draw", "html": ".show.html", "plot": ".show.figure",
    "summary": ".show.summary", "open": ".live.page",
}  # fmt: skip
"""Module of each name that is loaded on first use; a different name in that module follows a colon."""

_MODULES = {"fields": ".fields", "gym": ".gym", "si": ".reading.units.si", "spatial": ".spatial"}

_OFFERED = "AssemblyError", "InputError", "SolverError", "StiffmbsError", "si", *_LATER


def __getattr__(name: str) -> Any:
    if name == "__all__":
        return [name for name in (*_OFFERED, *elements_of(_KINDS)) if name != "open"]  # a built-in of the program
    if name in _MODULES:
        from importlib import import_module

        return import_module(_MODULES[name], __name__)
    return loaded(name, __name__, _KINDS, _LATER)


def __dir__() -> list[str]:
    return sorted({*globals(), *_OFFERED, *elements_of(_KINDS), *_MODULES})
