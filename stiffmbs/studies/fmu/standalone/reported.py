"""Requests of a scene as compiled formulas, so that an FMU computes them without Python."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import replace

from pydantic import Field

from ....elements.element import Expr, Force, Symbolic
from ....elements.own_elements import REGISTRY
from ....elements.spatial.marker import Marker as SpatialMarker
from ....errors import InputError
from ....model.files.stages import WrittenScene
from ....model.read_scene import read_changed
from ....model.scene import Scene
from ....reading.formula.field import OfMotion
from ....reading.marker import Marker

OF_REQUEST = "of_request_{}"
"""Name of the element of a request, by its number."""


class _Reported(Force):
    """Formula of positions, velocities, measures and time that is only reported."""

    kind = "reported_formula"
    channels = ("value",)
    has_reaction = False

    formula: OfMotion = Field(description="the reported value")

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Expr, Expr]]:
        """Return no effort."""
        return []

    @classmethod
    def measured(cls, e: Symbolic) -> list[Expr]:
        """Return the value."""
        return [e.formula]


class Reported(_Reported):
    """Reported formula of a planar scene; `i` is the marker of any body."""

    i: Marker


class ReportedInSpace(_Reported):
    """Reported formula of a spatial scene; `i` is the marker of any body."""

    i: SpatialMarker


@contextmanager
def registered() -> Iterator[None]:
    """Let scenes have elements of these kinds within a context."""
    with REGISTRY.including(Reported), REGISTRY.including(ReportedInSpace):
        yield


def with_reported(scene: Scene, written: WrittenScene, outputs: Collection[str]) -> tuple[WrittenScene, dict[str, str]]:
    """Return the source of a scene with an element for each request among `outputs`, where possible, and its channel by request.

    It is not possible for formulas of reactions, accelerations, energies or other requests, and for those of parts. A formula of time
    bounds the steps, so that only those of outputs have one.
    """
    section, found = written.content.get("requests"), {}
    for number, (name, output) in enumerate(scene.outputs().items()):
        if not isinstance(section, dict) or name.partition(".")[0] not in section or name not in outputs:
            continue
        element = OF_REQUEST.format(number)
        change = f"forces.{element}", {"type": Reported.kind, "i": next(iter(scene.bodies)), "formula": output.text}
        extended = replace(written, changes=(*written.changes, change))
        try:
            read_changed(extended, ())
        except InputError:
            continue
        written, found[name] = extended, f"{element}.{Reported.channels[0]}"
    return written, found
