"""Loads on the surfaces of flexible bodies, as forces on their frames and modal coordinates."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, field_validator, model_validator

from ..elements.body import LineBody, is_surface_load
from ..errors import InputError, prefixed
from ..flexible_bodies.reduced import reduced_body
from ..flexible_bodies.reduction import ReducedBody
from ..reading.did_you_mean import did_you_mean
from ..reading.fields import located
from ..reading.files.quoted import quoted
from ..reading.files.yaml_text import Content
from ..reading.handle import Handles
from .flexible import BY_BODY, FRAME, MODES, described_bodies

Load = Annotated[float, Field(strict=True, allow_inf_nan=False)] | str
"""Number or formula; neither true nor false."""


class SurfaceLoad(LineBody):
    """Pressure or traction on a surface of a flexible body: an entry of the forces of a scene.

    It becomes a force and a torque on the frame of the body, and forces on its modal coordinates. Their names begin with those of
    the body and of the load: ``plate.wind.frame``.
    """

    type: Literal["surface_load"] = "surface_load"
    body: str = Field(description="name of the flexible body")
    surface: str = Field(description="one of its surfaces")
    pressure: Load | None = Field(
        None, description="pressure against the outer normal of the undeformed surface, Pa: a number or a formula"
    )
    traction: tuple[Load, Load, Load] | None = Field(
        None, description="force per area along the axes of the body's mesh, Pa: numbers or formulas"
    )

    @field_validator("body", mode="before")
    @classmethod
    def _name_of_a_handle(cls, found: object) -> object:
        return found.name if isinstance(found, Handles) else found

    @model_validator(mode="after")
    def _any_load(self) -> Self:
        if self.pressure is None and self.traction is None:
            raise ValueError("found neither pressure nor traction, expected one of them or both")
        return self

    def loads(self) -> list[Load]:
        """Return the factors of the unit loads, Pa: pressure, and traction along x, y and z."""
        return [self.pressure or 0.0, *(self.traction or (0.0, 0.0, 0.0))]

    def forces(self, name: str, bodies: Mapping[str, Any]) -> dict[str, dict[str, object]]:
        """Return the forces of the load by their names, as entries of a scene.

        `name`: that of the load. `bodies`: those of the scene or model. Raises InputError if there is no such body or surface,
        or a part of the body has the name.
        """
        flexible = described_bodies(bodies)
        if self.body not in flexible:
            near = did_you_mean(self.body, flexible)
            listed = ", ".join(flexible) or "one of type flexible"
            raise InputError(f"body: found the unknown flexible body '{quoted(self.body)}'{near}, expected {listed}")
        if f"{self.body}.{name}" in bodies:
            raise InputError(
                f"body: found '{self.body}', which has a part '{name}' too, expected another name of the load"
            )
        surfaces = list(flexible[self.body].surfaces)
        if self.surface not in surfaces:
            near = did_you_mean(self.surface, surfaces)
            raise InputError(
                f"surface: found the unknown surface '{quoted(self.surface)}'{near}, expected one of {self.body} "
                f"({', '.join(surfaces) or 'it has none'})"
            )
        reduced = reduced_body(*bodies[f"{self.body}.{FRAME}"].source)
        made = _forces(self, reduced, surfaces.index(self.surface))
        return {f"{self.body}.{name}.{own}": entry for own, entry in made}

    def depends_on(self) -> str:
        return self.body

    def add_to(self, model: Any, name: str) -> None:
        """Add the forces to a model built in Python."""
        with prefixed(f"{name}."):
            made = self.forces(name, model.bodies)
        for full, entry in made.items():
            model.add(full, model.kinds[1][entry.pop("type")](**entry))


def with_surface_loads(raw: Content, context: Mapping[str, object]) -> dict[str, object]:
    """Return a scene whose surface loads are replaced by forces. Raises InputError.

    The bodies are those after the expansion of parts.
    """
    bodies, forces = raw.get("bodies") or {}, raw["forces"]
    found: dict[str, object] = {}
    for name, entry in forces.items():
        if not is_surface_load(entry):
            found[name] = entry
            continue
        with located(f"forces.{name}"):
            load = SurfaceLoad.model_validate(entry, context=dict(context))
        with prefixed(f"forces.{name}."):
            made = load.forces(name, bodies)
        for full, value in made.items():
            if full in forces:
                raise InputError(f"forces.{full}: found a name that the load '{name}' makes too, expected another")
            found[full] = value
    return {**raw, "forces": found}


def _forces(load: SurfaceLoad, body: ReducedBody, surface: int) -> Iterable[tuple[str, dict[str, object]]]:
    """Yield the forces of a load by their names, as entries of a scene.

    By the principle of virtual work. The torque changes with the displacements of the loaded nodes.
    """
    frame, values = f"{load.body}.{FRAME}", load.loads()
    wrench, modal, arms = body.wrenches[surface], body.modal_loads[surface], body.arms[surface]
    count = -(-modal.shape[1] // BY_BODY)
    # by modal coordinates in m
    modal = np.pad(np.sqrt(body.mass) * modal, ((0, 0), (0, BY_BODY * count - modal.shape[1])))
    arms = np.pad(np.sqrt(body.mass) * arms, ((0, 0), (0, BY_BODY * count - arms.shape[1]), (0, 0)))
    at_centre = {"i": {"body": frame, "point": body.centre.tolist()}, "axes": "body"}
    yield "frame", {"type": "force", **at_centre, "force": [_sum(wrench[:, k], values) for k in range(3)]}
    coordinates = [f"{load.body}.{MODES}{1 + k // BY_BODY}.{'xyz'[k % BY_BODY]}" for k in range(BY_BODY * count)]
    torque = [_torque(wrench[:, 3 + k], arms[:, :, k], values, coordinates) for k in range(3)]
    yield "torque", {"type": "torque", "i": {"body": frame}, "axes": "body", "torque": torque}
    for k in range(count):
        own = modal[:, BY_BODY * k : BY_BODY * (k + 1)]
        yield f"{MODES}{k + 1}", {
            "type": "force", "i": {"body": f"{load.body}.{MODES}{k + 1}"}, "force": [_sum(own[:, each], values) for each in range(BY_BODY)]
        }  # fmt: skip


def _sum(factors: np.ndarray, values: Sequence[Load]) -> Load:
    """Return the sum of products of factors, m^2, and loads, Pa."""
    if not any(isinstance(value, str) for value in values):
        return float(factors @ np.array(values))
    return " + ".join(_product(f"{factor!r} m^2", value) for factor, value in _used(factors, values)) or 0.0


def _torque(at_rest: np.ndarray, arms: np.ndarray, values: Sequence[Load], coordinates: Sequence[str]) -> Load:
    """Return the torque of loads, with the part by the displacements of their nodes."""
    parts = []
    for factor, of_modes, value in zip(at_rest.tolist(), arms.tolist(), values, strict=True):
        moved = [f"{arm!r} m^2*{name}" for arm, name in zip(of_modes, coordinates, strict=True) if arm]
        if value and (factor or moved):
            parts.append(_product(" + ".join([f"{factor!r} m^3", *moved]), value))
    return " + ".join(parts) or 0.0


def _used(factors: np.ndarray, values: Sequence[Load]) -> list[tuple[float, Load]]:
    return [(factor, value) for factor, value in zip(factors.tolist(), values, strict=True) if factor and value]


def _product(factor: str, value: Load) -> str:
    """Return a product as text; a formula keeps its units, and a plain number is in Pa."""
    return f"({factor})*(({value}) + 0 Pa)" if isinstance(value, str) else f"({factor})*({value!r} Pa)"
