"""Settings of runs."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from sys import float_info
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypedDict, TypeVar, Unpack, get_args

from pydantic import Field, ValidationInfo, field_validator, model_validator

from ..reading.fields import Described, Measured
from ..reading.given import Number
from ..reading.units import si
from ..reading.units.quantity import LARGEST
from ..reading.variation import MOST_VALUES
from ..solver_names import CHOICES, FormulationName, SchemeName, SolverName

DEFAULT_RTOL = 1e-6
"""Relative tolerance of a run without settings."""
LARGEST_RTOL = 0.1
"""Largest relative tolerance."""
DEFAULT_POINTS = 1001
"""Output times of a run without settings for them, and largest number of its states from which growth is estimated."""
MOST_OUTPUTS = MOST_VALUES
"""Largest number of output times of a run."""
FEWEST_APART, ROUNDINGS_APART = 1000, 2e-14
"""Smallest number of distinguishable time intervals of a run, and their smallest length relative to the time itself."""
SHORTEST = 1 / LARGEST
"""Shortest duration, s; products of shorter steps underflow."""
StartPose = Literal["described", "equilibrium", "settled"]
"""Poses in which a scene starts."""


class Settings(TypedDict, total=False):
    """Fields of `RunSettings` for type checkers, as keyword arguments of `run`."""

    duration: Number
    start: Number
    output: Number | None
    points: int | Literal["steps"] | None
    solver: SolverName
    formulation: FormulationName
    stabilisation: Number
    scheme: SchemeName
    rtol: Number
    atol: Number | None
    step: Number
    projection: bool
    max_step: Number
    max_order: int | None
    stages: Literal[3, 5, 7, "auto"]
    presolve: bool
    drop_first: Sequence[str]
    errors: bool | None
    accuracy: Mapping[str, str]
    tuning: Mapping[str, Mapping[str, Any]]


class RunSettings(Described):
    """Duration, output and solver of a run."""

    duration: si.PositiveTime = Field(10.0, description="s")
    start: si.Time = Field(0.0, description="time at the start, s")
    output: si.PositiveTime | None = Field(
        None, description="output interval, s; by default a thousandth of the duration"
    )
    points: int | Literal["steps"] | None = Field(
        None,
        description="number of output times, equally spaced, with both ends; or steps, for the steps of the solver",
    )
    solver: SolverName = Field(
        "bdf",
        description="bdf (SUNDIALS IDA), radau (Radau IIA), projected (explicit or linearly implicit, with projection onto the constraints), kinematic (for scenes whose drives fix every coordinate), or auto (projected, and bdf while the scene is stiff)",
    )
    formulation: FormulationName = Field("SI2", description="of the residual of bdf and radau")
    stabilisation: Annotated[float, Measured("angular velocity", at_least=0)] = Field(
        0.0, description="of index1: rate at which violations decay, 1/s; 0 shows its drift"
    )
    scheme: SchemeName | None = Field(
        None,
        description="scheme of projected: euler_cromer, rk4, linearly_implicit_euler and extrapolated_euler (both for stiff scenes) have fixed steps, dopri5 and dop853 adaptive ones; dop853 by default, euler_cromer with a step",
    )
    rtol: Annotated[float, Measured("number", at_least=1e-14, at_most=LARGEST_RTOL)] = Field(
        DEFAULT_RTOL, description="relative error tolerance of bdf, radau and the adaptive schemes"
    )
    atol: si.PositiveNumber | None = Field(
        None,
        description="absolute error tolerance (m, rad, m/s, rad/s); by default rtol, times the size of a mechanism that is smaller than 1 m",
    )
    step: si.PositiveTime = Field(
        1e-3, description="step of the fixed schemes, s; reduced if it does not divide the time between output points"
    )
    projection: bool = Field(True, description="whether projected projects onto the constraints after each step")
    max_step: si.TimeOrZero = Field(
        0.0, description="largest step of bdf, radau and the adaptive schemes, s; 0 for none"
    )
    max_order: Annotated[int, Field(ge=1, le=5)] | None = Field(
        None,
        description="highest order of bdf, 1 to 5; by default 5, and temporarily 2 if orders 3 to 5 require very small steps for a stiff, lightly damped vibration",
    )
    stages: Literal[3, 5, 7, "auto"] = Field(
        "auto",
        description="of radau, whose order is 2 stages - 1; by default chosen by the convergence of Newton's iteration",
    )
    presolve: bool = Field(
        True, description="whether the model is reduced to a smaller problem with the same results, if possible"
    )
    drop_first: tuple[str, ...] = Field(
        (), description="joints whose redundant equations are dropped first, the last name first"
    )
    errors: bool | None = Field(
        None,
        description="whether the errors of all channels are estimated after the run; by default for runs of little work",
    )
    accuracy: dict[str, Any] = Field(
        {},
        description="largest errors of `positions`, `velocities` and `forces`, as part of the largest value (1 %) or with a unit (0.1 mm); rtol is then chosen by the estimate of the errors",
    )
    tuning: dict[str, dict[str, Any]] = Field(
        {}, description="changed parameters of solvers by subsystem and name (`stiffmbs.tuning`), for experts"
    )

    if TYPE_CHECKING:

        def __init__(self, **fields: Unpack[Settings]) -> None: ...

    @field_validator("solver", mode="before")
    @classmethod
    def _no_scheme(cls, solver: object) -> object:
        if solver in get_args(SchemeName):
            raise ValueError(
                f"found '{solver}', which is a scheme of the solver 'projected'; expected solver: projected, scheme: {solver}"
            )
        return solver

    @field_validator("start", mode="before")
    @classmethod
    def _no_pose(cls, start: object, info: ValidationInfo) -> object:
        named = start in get_args(StartPose) and start not in (info.context or {}).get("parameters", ())
        if named or isinstance(start, dict):
            found, entry = (f"'{start}'", start) if named else ("a mapping", "{...}")
            raise ValueError(
                f"found {found}, expected a time in s; 'start: {entry}' belongs to the scene, outside 'run'"
            )
        return start

    @field_validator("accuracy", mode="before")
    @classmethod
    def _known_groups(cls, found: object) -> object:
        if found:
            from .accuracy import wanted  # few runs have it

            wanted(found)
        return found

    @field_validator("tuning", mode="before")
    @classmethod
    def _known_parameters(cls, found: object, info: ValidationInfo) -> object:
        from .tuning import checked  # few runs have it

        return checked(found, lambda entry: Measured("number").read(entry, info))

    @model_validator(mode="after")
    def _one_grid(self) -> RunSettings:
        """Refuse two grids of output points, too many points, and spacings below the rounding error of the time."""
        if self.output is not None and self.points is not None:
            raise ValueError("found both 'output' and 'points', expected one of them")
        if isinstance(self.points, int) and self.points < 2:
            raise ValueError(f"points: found {self.points}, expected 2 or more")
        asked = self.duration / self.output if self.output is not None else self.points
        if isinstance(asked, int | float) and asked > MOST_OUTPUTS:
            raise ValueError(
                f"found {min(asked, float_info.max):.3g} output times, expected at most {MOST_OUTPUTS:.0e}: a pinned body takes 2 GB for so many"
            )
        if self.duration < SHORTEST:
            raise ValueError(f"duration: found {self.duration:.3g} s, expected {SHORTEST:.0e} s or more")
        count = self.points - 1 if isinstance(self.points, int) else FEWEST_APART
        spacing = min(self.duration, self.output or self.duration / count)
        least = ROUNDINGS_APART * max(abs(self.start), abs(self.start + self.duration))
        if spacing < least:
            raise ValueError(
                f"found output points {spacing:.3g} s apart at t = {self.start:.6g} s, expected {least:.3g} s or more: numbers of 16 "
                "digits do not distinguish shorter times there"
            )
        return self


class SteadyMotion(Described):
    """Motion of all bodies as one rigid body: along a straight line, or on circles about one axis, at constant speed.

    Adams calls such an equilibrium quasi-static.
    """

    velocity: tuple[si.Velocity, ...] = Field(
        (), description="of every point in addition to the rotation, in ground axes, m/s: one number for each dimension"
    )
    rotation: Literal["found"] | si.AngularVelocity | si.AngularVelocity3 = Field(
        0.0,
        description="angular velocity, rad/s: a number in the plane, in space a vector in ground axes, or a number about the direction opposite to gravity; `found` if forces determine it, as for a car that pulls to one side (also if no rotation is given and the forces do not balance on a straight line)",
    )
    about: tuple[si.Length, ...] = Field((), description="a point of the axis of rotation, m; by default the origin")
    rolling: tuple[str, ...] = Field(
        (),
        description="bodies with an additional spin about their axis of symmetry, determined by rolling constraints or by forces such as those of tyres; otherwise as described",
    )
    speed: Literal["given", "found"] = Field(
        "given",
        description="`found` if forces determine it, such as drag and a driver's traction: the velocity is then an initial guess along its line",
    )


Function = TypeVar("Function", bound=Callable[..., Any])


def _as_written(settings: type) -> list[tuple[str, str]]:
    """Return the fields of a typed dictionary with their types as text."""
    return [(name, kind.__forward_arg__) for name, kind in settings.__annotations__.items()]


class _AsItIs:
    """Default of a setting in a signature: the value of the scene or of the given settings."""

    def __repr__(self) -> str:
        return "..."


def takes_settings(function: Function) -> Function:
    """Add the settings to the signature of a function that takes them by keyword, for ``help`` and completion."""
    signature = inspect.signature(function)
    own = [parameter for parameter in signature.parameters.values() if parameter.kind is not parameter.VAR_KEYWORD]
    settings = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=_AsItIs(), annotation=CHOICES.get(kind, kind))
        for name, kind in _as_written(Settings)
    ]
    function.__signature__ = signature.replace(parameters=[*own, *settings])  # type: ignore[attr-defined]
    return function
