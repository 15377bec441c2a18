"""The types of what ``stiffmbs`` and ``stiffmbs.spatial`` offer, for type checkers and editors: `python .ci/stubs.py` writes them.

An element's fields take more than they hold (a body's name for a marker, text with a unit for a number), and modules load
their attributes when they are used; neither can be seen in the source without running it.
"""

from __future__ import annotations

import inspect
import subprocess
import types
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic_core import PydanticUndefined

import stiffmbs
from stiffmbs.elements.element import Element
from stiffmbs.elements.geometry import OneFor
from stiffmbs.elements.roads.envelope import Envelope
from stiffmbs.elements.roads.road import Road
from stiffmbs.elements.spatial.marker import Placement as SpatialPlacement
from stiffmbs.elements.spatial.orientation import OrientationField
from stiffmbs.elements.states.amount import Amount
from stiffmbs.elements.tyres.coefficients import TyreProperties
from stiffmbs.loaded_later import elements_of
from stiffmbs.reading.fields import Described, Measured
from stiffmbs.reading.formula.formula import Formula
from stiffmbs.reading.joint_name import JointName
from stiffmbs.reading.marker import MarkerReference, Placement
from stiffmbs.reading.python_function import PythonFunction
from stiffmbs.reading.table import Table

ROOT = Path(stiffmbs.__file__).parent
HEAD = '"""Types of the module; written by .ci/stubs.py."""\n'
PLANE = """
from collections.abc import Mapping, Sequence
from typing import Literal

from . import gym as gym
from . import spatial as spatial
from .adams.listing import listed_statements as listed_statements
from .comparison.compare import compare as compare
from .comparison.over import compare_over as compare_over
from .compile.compile_model import compile_model as compile_model
from .reading import given
from .reading.handle import Handle as _Handle
from .elements.element import Force as Force
from .elements.element import Joint as Joint
from .model.model import Model as Model
from .elements.own_elements import register as register
from .reading.python_function import PythonFunction as PythonFunction
from .model.scene import Scene as Scene
from .model.read_scene import read_scene as read_scene
from .model.schema import scene_schema as scene_schema
from .model.settings import RunSettings as RunSettings
from .model.settings import SteadyMotion as SteadyMotion
from .reading.units import si as si
from .live.page import open as open
from .errors import AssemblyError as AssemblyError
from .errors import InputError as InputError
from .errors import SolverError as SolverError
from .errors import StiffmbsError as StiffmbsError
from .evaluation.bearing_loads import DrivingAngle as DrivingAngle
from .evaluation.bearing_loads import driving_angle as driving_angle
from .evaluation.bearing_loads import in_body_axes as in_body_axes
from .evaluation.cycle import Cycle as Cycle
from .evaluation.cycle import cycle as cycle
from .evaluation.loads import Load as Load
from .evaluation.loads import loads as loads
from .evaluation.peaks import Peak as Peak
from .evaluation.peaks import peaks as peaks
from .analyses.check import Report as Report
from .analyses.check import check as check
from .analyses.equilibrium import equilibrium as equilibrium
from .analyses.equilibrium import quasi_static as quasi_static
from .analyses.load_scene import load_scene as load_scene
from .analyses.linearised.campbell import campbell as campbell
from .analyses.linearised.modes import modes as modes
from .analyses.run import run as run
from .analyses.linearised.transfer import transfer as transfer
from .results.listings import differences as differences
from .results.saved_state import SavedState as SavedState
from .results.saved_state import read_state as read_state
from .results.solution import Solution as Solution
from .show.drawing.animate import animate as animate
from .show.drawing.draw import draw as draw
from .show.figure import plot as plot
from .show.html import html as html
from .show.summary import summary as summary
from .studies.fit import Fit as Fit
from .studies.fit import fit as fit
from .studies.handling.study import Handling as Handling
from .studies.handling.study import handling as handling
from .studies.joint_space.space import JointSpace as JointSpace
from .studies.joint_space.space import joint_space as joint_space
from .studies.optimise import Optimum as Optimum
from .studies.optimise import optimise as optimise
from .studies.sensitivities.sensitivities import Sensitivity as Sensitivity
from .studies.sensitivities.sensitivities import sensitivities as sensitivities
from .studies.fmu.build import build_fmu as build_fmu
from .studies.follow import follow as follow
from .real_time.realtime import realtime as realtime
from .real_time.report import RealTime as RealTime
from .studies.simulation import Simulation as Simulation
from .studies.simulation import simulation as simulation
from .studies.simulations import Simulations as Simulations
from .studies.simulations import simulations as simulations
from .studies.suspension.kinematics_and_compliance import KinematicsAndCompliance as KinematicsAndCompliance
from .studies.suspension.kinematics_and_compliance import kinematics_and_compliance as kinematics_and_compliance
from .studies.suspension.road_loads import RoadLoads as RoadLoads
from .studies.suspension.road_loads import road_loads as road_loads
from .studies.suspension.vehicle import VehicleOptions as VehicleOptions
from .studies.sweep import sweep as sweep
from .reading.variation import Range as Range
from .verification.verify import verify as verify
"""
SPACE = """
from collections.abc import Mapping, Sequence
from typing import Literal

from .reading import given
from .reading.handle import Handle as _Handle
from .elements.element import Force as Force
from .elements.element import Joint as Joint
from .model.spatial_model import Model as Model
from .analyses.in_space import in_space as in_space
"""
VALUES = "__version__: str\nground: str"
MODULES = {"__init__.pyi": (PLANE, VALUES, stiffmbs), "spatial.pyi": (SPACE, "", stiffmbs.spatial)}
OTHERS = (
    "AlgebraicState",
    "BeamBody",
    "Body",
    "FlexibleBody",
    "SurfaceLoad",
    "LinearSystem",
    "Marker",
    "PID",
    "SampledState",
    "State",
    "Table",
    "TransferFunction",
)
"""Described classes besides elements."""


def stub(file: str) -> str:
    """The content of a stub, before it is formatted."""
    exports, others, module = MODULES[file]
    described = {name: getattr(module, name) for name in OTHERS if hasattr(module, name)}
    elements = sorted((elements_of(module._KINDS) | described).items())
    imports = [f"from {element.__module__} import {element.__name__} as _{name}" for name, element in elements]
    classes = ["\n".join(_class(name, element)) for name, element in elements]
    return "\n\n".join([HEAD + exports + "\n".join(imports), others, *classes]) + "\n"


def _class(name: str, element: type[Any]) -> Iterator[str]:
    yield f"class {name}(_{name}):"
    yield f'    """{(inspect.getdoc(element) or name).partition(chr(10) * 2)[0]}"""'
    fields = [_field(key, field) for key, field in element.model_fields.items() if key != "type"]
    if issubclass(element, Element):
        fields.append(f"type: Literal['{element.kind}'] = ...")
    yield f"    def __init__(self, *, {', '.join(fields)}) -> None: ..."


def _field(name: str, field: Any) -> str:
    taken = GIVEN_AS.get(name) or _given(field.annotation, field.metadata)
    required = field.default is PydanticUndefined and field.default_factory is None
    return f"{field.alias or name}: {taken}{'' if required else ' = ...'}"


def _given(annotation: Any, metadata: Any = ()) -> str:
    """The type of what may be given for a field."""
    for mark, word in ((OrientationField, "given.Orientation"), (OneFor, "given.Geometry")):
        if any(isinstance(one, mark) for one in metadata):
            return word
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _given(parts[0], parts[1:])
    if origin is Literal:
        return f"Literal[{', '.join(map(repr, parts))}]"
    if origin in (Union, types.UnionType):
        if {Formula, Table} <= set(parts):
            return "given.Curve" + (" | None" if type(None) in parts else "")
        if {float, str} <= {get_args(part)[0] if get_origin(part) is Annotated else part for part in parts}:
            return "given.Law" + (" | None" if type(None) in parts else "")
        return " | ".join(dict.fromkeys(_given(part) for part in parts))
    if origin is tuple:
        return _of_many([_given(part) for part in parts if part is not Ellipsis])
    if origin is dict:
        return "given.Markers" if parts[1] in PLACEMENTS else f"Mapping[str, {_given(parts[1])}]"
    return _named(annotation, metadata)


def _of_many(parts: list[str]) -> str:
    inner = {part.removesuffix(" | None") for part in parts}
    if inner <= {"given.Number"}:
        return "given.Numbers"
    if inner <= {"given.Numbers"}:
        return "given.Matrix"
    if inner <= {"given.Law"}:
        return "given.Laws"
    if inner <= {"given.Marker"}:
        return "given.MarkerSequence"
    if len(inner) == 1 and not any("given" in part for part in inner):
        return f"Sequence[{inner.pop()}]"
    raise TypeError(f"found a field of several {inner}, expected numbers, rows of them, formulas or markers")


TAKEN: Mapping[type, str] = {
    MarkerReference: "given.Marker",
    JointName: "str",
    Formula: "given.Law",
    PythonFunction: "given.Function",
    Table: "given.Curve",
    Road: "given.Road",
    TyreProperties: "given.TyreProperties",
    Envelope: "given.Envelope",
    Described: "Mapping[str, object]",
}
GIVEN_AS = {"body": "str | _Handle", "elements": "given.Number | Sequence[int] | Mapping[str, given.Number]"}
"""Types of fields that take more than their own type shows."""
PLACEMENTS = (Placement, SpatialPlacement)
PLAIN = {bool: "bool", int: "int", str: "str", type(None): "None"}


def _named(annotation: Any, metadata: Any) -> str:
    if annotation in (float, Amount) or any(isinstance(mark, Measured) for mark in metadata):
        return "given.Number"
    if annotation in PLAIN:
        return PLAIN[annotation]
    if annotation is Any:
        return "Mapping[str, object]"
    for base, word in TAKEN.items():
        if issubclass(annotation, base):
            return word
    raise TypeError(f"found a field of {annotation}, expected a type that this file knows")


def main() -> None:
    for file in MODULES:
        (ROOT / file).write_text(stub(file), encoding="utf-8")
    paths = [str(ROOT / file) for file in MODULES]
    subprocess.run(["ruff", "check", "--fix", "--quiet", *paths], check=True)
    subprocess.run(["ruff", "format", "--quiet", *paths], check=True)


if __name__ == "__main__":
    main()
