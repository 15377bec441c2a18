"""Scenes: models with run settings, as in files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, PrivateAttr, field_validator, model_validator

from ..elements.element import Component
from ..elements.read_by import of_class
from ..elements.requests.check import check_output
from ..elements.requests.order import dimension, dimensions
from ..elements.roads.field import ROAD
from ..errors import prefixed
from ..notes import of_users
from ..reading.fields import Described
from ..reading.files.unchanged import Unchanged
from ..reading.formula.text import FormulaError
from ..reading.table import Table
from ..reading.units.display import DisplayUnits, checked_units
from ..reading.units.units import Quantity, in_text
from .beams.division import Beams
from .files.written_scene import WrittenScene
from .model_data import ModelData
from .settings import RunSettings, StartPose, SteadyMotion

if TYPE_CHECKING:
    from .files.stages import Stage
    from .parts.as_described import AsDescribed


def _stage() -> type[Stage]:
    from .files.stages import Stage

    return Stage


class Figure(Described):
    """Plot of channels, drawn by ``stiffmbs run SCENE --figure FILE``."""

    title: str = Field("", description="shown above the plot")
    x: str = Field("time", description="a channel, or time")
    y: tuple[str, ...] = Field(min_length=1, description="channels")
    z: str = Field("", description="a channel: then a path in space over x, one y and z")
    equal: bool = Field(False, description="one scale for all axes, as for paths")

    @model_validator(mode="after")
    def _one_path(self) -> Figure:
        if self.z and (len(self.y) > 1 or self.x == "time"):
            raise ValueError(
                f"z: found '{self.z}' with x: {self.x}, y: {', '.join(self.y)}, expected a channel x and one y"
            )
        return self


class Scene(ModelData):
    """Model and its run settings, as read from a file."""

    parameters: dict[str, float | str] = Field(default_factory=dict, description="names for use in formulas")
    tables: dict[str, Table] = Field(default_factory=dict, description="curves that formulas call by name: curve(t)")
    roads: dict[str, Annotated[Any, ROAD]] = Field(default_factory=dict, description="roads that tyres name")
    variables: dict[str, Any] = Field(default_factory=dict, description="formulas by name, which other formulas use")
    run: RunSettings = Field(default_factory=RunSettings, description="how to run the scene")
    start: StartPose | SteadyMotion = Field(
        "described",
        description="where a run starts: as described, at rest in the equilibrium found from there, in its pose with the "
        "described velocities (settled), or in steady motion",
    )
    at_start: dict[str, Any] = Field(
        default_factory=dict, description="joints and drives that hold only at the start, by name"
    )
    stages: tuple[Annotated[Any, of_class(_stage)], ...] = Field(
        (), description="consecutive runs, each with its own changes"
    )
    figure: Figure | None = Field(None, description="the main plot of the scene")
    units: dict[str, str] = Field(
        default_factory=dict,
        description="units of tables, plots and pages by dimension, such as {angle: deg, force: kN}",
    )
    notes: tuple[str, ...] = Field((), description="text shown with every result")
    _quantities: Mapping[str, Quantity] = PrivateAttr(default_factory=dict)
    _written: WrittenScene | None = PrivateAttr(default=None)
    _validated: Unchanged = PrivateAttr(default_factory=Unchanged)
    _stage_scenes: tuple[Scene, ...] = PrivateAttr(default=())
    _held_at_start: Scene | None = PrivateAttr(default=None)
    _beams: Beams = PrivateAttr(default_factory=Beams)
    _of_parts: AsDescribed | None = PrivateAttr(default=None)

    @field_validator("units")
    @classmethod
    def _units_of_dimensions(cls, found: dict[str, str]) -> dict[str, str]:
        return checked_units(found)

    @property
    def display(self) -> DisplayUnits:
        """Units in which results are shown."""
        return DisplayUnits(self.units)

    def check_requests(self) -> None:
        """Refuse invalid requests, and invalid variables, which are read as requests."""
        super().check_requests()
        outputs = self.outputs()
        requests = dimensions(outputs)
        for name, output in self.variables.items():
            check_output(f"variables.{name}", output, self, self.output_names, outputs)
            with prefixed(f"variables.{name}: ", FormulaError, ValueError):
                dimension(output, requests)

    def written_parameters(self) -> dict[str, float | str]:
        """Return the parameters with their units, as in a scene."""
        return {name: in_text(self._quantities.get(name, Quantity(value))) for name, value in self.parameters.items()}  # type: ignore[arg-type]

    @property
    def stage_scenes(self) -> tuple[Scene, ...]:
        """Scenes of the stages, in order."""
        return self._stage_scenes

    @property
    def held_at_start(self) -> Scene | None:
        """Scene with its initial conditions of joints; None without any."""
        return self._held_at_start

    @property
    def beams(self) -> Beams:
        """Beams and how they are divided into elements."""
        return self._beams

    @property
    def is_as_read(self) -> bool:
        """Return True if it is as it was read, not a changed copy."""
        as_read = self.validated.scene
        return as_read is None or as_read is self or bool(as_read == self)

    @property
    def whole_duration(self) -> float:
        """Total duration of all stages, s."""
        if not self.stages:
            return self.run.duration
        time = 0.0
        for stage, scene in zip(self.stages, self.stage_scenes, strict=True):
            if stage.over_time:
                time = time + scene.run.duration if stage.end is None else max(time, stage.end)
        return time

    @property
    def of_parts(self) -> AsDescribed | None:
        """Values of parts before these are placed; None for a scene without parts."""
        return self._of_parts

    @property
    def written(self) -> WrittenScene | None:
        """Source of the scene, for reading it with other values; None if it was not read."""
        return self._written

    @property
    def validated(self) -> Unchanged:
        """Validated entries for reading with other values; a changed copy has those of the original scene."""
        return self._validated


def notes_of(model: ModelData) -> tuple[str, ...]:
    """Return the notes of a scene, and of the roads, tyres and flexible bodies of a model."""
    of_parts: list[tuple[str, str]] = []
    for name, element in model.forces.items():
        components = (component for _, component in element.parts(Component))
        of_parts += ((name, note) for note in element.own_notes())
        of_parts += ((name, note) for component in components for note in component.notes())
    own = list(model.notes) if isinstance(model, Scene) else []
    if model.dimensions == 3:
        from ..elements.spatial.flexible.bodies import FloatingFrame

        for name, body in model.bodies.items():
            if isinstance(body, FloatingFrame):
                of_parts += ((f"'{name.removesuffix('.frame')}'", note) for note in body.notes)
    if model.dimensions == 3 and len(model.forces) > 1:
        from .wheels import mounted_alike

        own += mounted_alike(model)
    return (*own, *of_users(of_parts)) if of_parts else tuple(own)


def scene_class(dimensions: int) -> type[Scene]:
    """Return the class of planar or spatial scenes, which is imported on demand."""
    if dimensions == 2:
        from .planar_scene import PlanarScene

        return PlanarScene
    from .spatial_scene import SpatialScene

    return SpatialScene
