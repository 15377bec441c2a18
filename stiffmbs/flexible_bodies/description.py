"""Description of a flexible body: mesh or matrices, material, interfaces and number of modes."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)

from ..errors import InputError, prefixed
from ..reading.did_you_mean import did_you_mean
from ..reading.fields import Described, sentence
from ..reading.files.quoted import written
from ..reading.files.text_file import file_content
from ..reading.units import si
from .areas import nodal_areas, unit_loads
from .finite_elements import PRECISION, FiniteElements
from .interfaces import AVERAGE, POINT, Interface
from .mirrored import mirrored

Point = si.Point3


def _not_zero(normal: tuple[float, float, float]) -> tuple[float, float, float]:
    if not any(normal):
        raise ValueError("found zero, expected a direction")
    return normal


Direction = Annotated[tuple[si.Number, si.Number, si.Number], AfterValidator(_not_zero)]
NOT_CYCLES = re.compile(r"\b(rpm|rad|deg|rev)\b")


class Units(Described):
    """Units of the numbers in the files of a flexible body."""

    length: si.PositiveLength = Field(description="unit of length, such as mm")
    mass: si.PositiveMass = Field(1.0, description="unit of mass in K and M, such as tonne")
    time: si.PositiveTime = Field(1.0, description="unit of time in K and M")


class Material(Described):
    """Isotropic, linearly elastic material."""

    E: si.PositivePressure = Field(description="Young's modulus, N/m^2")
    nu: si.Number = Field(description="Poisson's ratio, above -1 and below 0.5")
    density: si.PositiveDensity = Field(description="density, kg/m^3")

    @field_validator("nu")
    @classmethod
    def _stable(cls, nu: float) -> float:
        if not -1 < nu < 0.5:
            raise ValueError(f"found {nu:g}, expected a Poisson's ratio above -1 and below 0.5")
        return nu


class Matrices(Described):
    """Files of the matrices of a finite element model."""

    stiffness: str = Field(description="file of K: .mtx, .op2, .op4, .pch, .full or .sti")
    mass: str = Field(description="file of M: .mtx, .op2, .op4, .pch, .full or .mas")
    nodes: str = Field(description="file of the nodes: .bdf, .inp, .cdb, or lines of x, y and z, also after a number")
    rows: str | None = Field(None, description="file of CalculiX with node and component of each row: .dof")
    stiffness_name: str | None = Field(None, description="name of K in a file with several matrices, such as KGG")
    mass_name: str | None = Field(None, description="name of M in such a file")


class Thickness(Described):
    """Stretch of a mesh along a direction, about the middle of its extent; groups and selections are those before it."""

    scale: si.PositiveNumber = Field(1.0, description="factor of the thickness")
    normal: Direction = Field(description="direction of the thickness, in the axes of the mesh")

    def moved(self, points: np.ndarray, nodes: np.ndarray, scale: float) -> np.ndarray:
        """Return points stretched by a factor about the middle of the nodes, both of shape (n, 3)."""
        along = np.array(self.normal) / np.linalg.norm(self.normal)
        heights = nodes @ along
        middle = (heights.min() + heights.max()) / 2
        return points + (scale - 1) * np.outer(points @ along - middle, along)


LengthOrStretch = Annotated[
    Annotated[si.PositiveLength, Tag("float")] | Annotated[Thickness, Tag("stretch")],
    Discriminator(lambda found: "stretch" if isinstance(found, Thickness) else "float"),
]


class Sphere(Described):
    """Sphere that selects the nodes within it."""

    center: Point = Field(description="centre in the coordinates of the mesh, m")
    radius: si.PositiveLength = Field(description="radius, m")


class Plane(Described):
    """Plane that selects the nodes on it."""

    point: Point = Field(description="a point of the plane in the coordinates of the mesh, m")
    normal: Direction = Field(description="normal of the plane")
    within: si.PositiveLength | None = Field(None, description="largest distance of a node, m")


class SelectedNodes(Described):
    """Nodes of a finite element model, selected by exactly one of the keys."""

    nodes: tuple[int, ...] | None = Field(
        None, description="node numbers of the file of nodes; for a mesh or an archive, from 0 in its order"
    )
    group: str | None = Field(None, description="named group of nodes of the file")
    sphere: Sphere | None = Field(None, description="all nodes within a sphere")
    plane: Plane | None = Field(None, description="all nodes on a plane")

    @model_validator(mode="after")
    def _one_selection(self) -> Self:
        given = [name for name in ("nodes", "group", "sphere", "plane") if getattr(self, name) is not None]
        if len(given) != 1:
            found = " and ".join(given) or "none"
            raise ValueError(f"found {found} of nodes, group, sphere and plane, expected exactly one of them")
        return self

    def selected(self, where: str, model: FiniteElements) -> np.ndarray:
        """Return the numbers of the nodes of a model, from 0 and in increasing order. Raises InputError."""
        return np.unique(np.asarray(self._selected(where, model), dtype=np.int64))

    def _selected(self, where: str, model: FiniteElements) -> object:
        if self.group is not None:
            if self.group not in model.groups:
                listed = ", ".join(model.groups) or "none"
                near = did_you_mean(self.group, model.groups)
                raise InputError(
                    f"{where}.group: found no group '{self.group}'{near}, expected one of the file ({listed})"
                )
            return model.groups[self.group]
        if self.sphere is not None:
            return np.flatnonzero(np.linalg.norm(model.nodes - self.sphere.center, axis=1) <= self.sphere.radius)
        if self.plane is not None:
            within = self.plane.within or PRECISION * np.ptp(model.nodes, axis=0).max()
            across = np.array(self.plane.normal) / np.linalg.norm(self.plane.normal)
            return np.flatnonzero(np.abs((model.nodes - self.plane.point) @ across) <= within)
        assert self.nodes is not None
        numbers = np.arange(len(model.nodes)) if model.numbers is None else model.numbers
        unknown = np.setdiff1d(self.nodes, numbers)
        if len(unknown):
            raise InputError(
                f"{where}.nodes: found node {unknown[0]}, expected {numbers[0]} to {numbers[-1]}"
                f"{'' if len(numbers) > numbers[-1] - numbers[0] else ' (numbers of the file)'}"
            )
        return np.searchsorted(numbers, self.nodes)


class InterfaceOfNodes(SelectedNodes):
    """Interface: nodes of the body that move with a marker."""

    type: Literal["rigid", "average", "point"] = Field(
        "rigid",
        description="rigid: the nodes are a rigid body (RBE2); average: their mean motion (RBE3); point: one node",
    )
    weights: Literal["equal", "area"] = Field(
        "equal", description="of the nodes of an average: equal, or area: shares of the faces between them"
    )
    point: Point | None = Field(
        None, description="reference point, m; the mean of the nodes, with their weights, by default"
    )

    @model_validator(mode="after")
    def _of_an_average(self) -> Self:
        if self.weights == "area" and self.type != AVERAGE:
            raise ValueError(f"found weights: area with type: {self.type}, expected them with type: average")
        return self

    def on(self, name: str, model: FiniteElements) -> Interface:
        """Return the interface on a model. Raises InputError."""
        nodes = self.selected(f"interfaces.{name}", model)
        if self.point is not None and self.type == POINT:
            raise InputError(f"interfaces.{name}.point: found a reference point, expected none for type: point")
        weights = self._weights(name, model, nodes)
        mean = np.average(model.nodes[nodes], axis=0, weights=weights) if len(nodes) else np.zeros(3)
        return Interface(name, self.type, nodes, mean if self.point is None else np.array(self.point), weights)

    def _weights(self, name: str, model: FiniteElements, nodes: np.ndarray) -> np.ndarray | None:
        if self.weights == "equal":
            return None
        areas = nodal_areas(model, nodes)
        if not areas.sum() > 0:
            raise InputError(
                f"interfaces.{name}.weights: found no face of an element between the nodes, expected a surface of a mesh"
            )
        return areas


class Surface(SelectedNodes):
    """Surface for loads: the faces of elements, or the shells, all of whose nodes are selected."""

    outside: Direction | None = Field(
        None,
        description="direction to the outer side of shells, in the axes of the mesh; by default that of their normals by the order of their nodes",
    )


Mirror = Literal["x", "y", "z", "xy", "xz", "yz", "xyz"]
"""Coordinates that change their signs."""


class UpTo(Described):
    """Normal modes up to a frequency."""

    up_to: si.PositiveFrequency = Field(description="highest frequency of a mode with the interfaces held, Hz")

    @field_validator("up_to", mode="before")
    @classmethod
    def _cycles(cls, found: object) -> object:
        if isinstance(found, str) and NOT_CYCLES.search(found):
            raise ValueError(f"found '{found}', expected a frequency in Hz")
        return found


def _of_mapping(described: type[Described], found: object, info: ValidationInfo) -> object:
    """Return the description in a mapping, and anything else as it is. Raises ValueError with one sentence."""
    if not isinstance(found, dict):
        return found
    try:
        return described.model_validate(found, context=info.context)
    except ValidationError as error:
        raise ValueError(sentence(error)) from None


class FlexibleBody(Described):
    """Flexible body: a finite element model with interfaces, reduced by the Hurty-Craig-Bampton method.

    A mesh needs a material; its elements are solids, shells with a thickness, or both.
    """

    mesh: str | None = Field(
        None, description="file of a mesh of tetrahedra, hexahedra, wedges or pyramids, of shells, or of both"
    )
    matrices: str | Matrices | None = Field(None, description="NumPy archive (.npz), or files of K, M and nodes")
    units: Units = Field(description="units of the file")
    material: Material | None = Field(None, description="material of a mesh")
    materials: dict[str, Material] | None = Field(
        None, description="materials by groups of the mesh's elements, in place of one material"
    )
    thickness: LengthOrStretch | None = Field(
        None, description="of the shells of a mesh, m, or stretch of a mesh of solids along its thickness"
    )
    thicknesses: dict[str, si.PositiveLength] | None = Field(
        None, description="thicknesses by groups of the mesh's shells, m; with solids, other surfaces are groups only"
    )
    interfaces: dict[str, InterfaceOfNodes] = Field(default_factory=dict, description="nodes that move with markers")
    surfaces: dict[str, Surface] = Field(
        default_factory=dict,
        description="surfaces for loads by name, of a mesh; each adds its static displacements to the modes",
    )
    modes: int | UpTo = Field(20, description="number of normal modes, or up_to: a frequency")
    mass: si.PositiveMass | None = Field(None, description="stated mass, kg, to check units and density")
    stiffening: bool | Literal["auto"] = Field("auto", description="geometric stiffening; auto: for a body with a mesh")
    mirror: Mirror | None = Field(None, description="coordinates of the file that change their signs, such as y or xy")
    residual_modes: bool = Field(
        False, description="static correction: add the displacements under uniform accelerations to the modes"
    )

    @field_validator("thickness", mode="before")
    @classmethod
    def _length_or_stretch(cls, found: object, info: ValidationInfo) -> object:
        return _of_mapping(Thickness, found, info)

    @field_validator("modes", mode="before")
    @classmethod
    def _count_or_frequency(cls, found: object, info: ValidationInfo) -> object:
        found = _of_mapping(UpTo, found, info)
        if not isinstance(found, UpTo) and (isinstance(found, bool) or not isinstance(found, int) or found < 0):
            raise ValueError(f"found {written(found)}, expected a number of modes, or up_to: a frequency")
        return found

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if (self.mesh is None) == (self.matrices is None):
            found = "both" if self.mesh else "neither"
            raise ValueError(f"found {found} of 'mesh' and 'matrices', expected exactly one of them")
        given = [name for name in ("material", "materials") if getattr(self, name)]
        if len(given) != (self.mesh is not None):
            found = " and ".join(given) or "no material"
            raise ValueError(
                f"found {found}, expected {'E, nu and density for a mesh' if self.mesh else 'none: K and M have it'}"
                f"{', in one of them' * (len(given) > 1)}"
            )
        given = [name for name in ("thickness", "thicknesses") if getattr(self, name)]
        if given and self.mesh is None:
            raise ValueError("found a thickness with matrices, expected a mesh")
        if len(given) > 1:
            raise ValueError("found thickness and thicknesses, expected one of them")
        if self.surfaces and self.mesh is None:
            raise ValueError("found surfaces with matrices, expected a mesh: its elements have faces")
        if self.stiffening is True and self.mesh is None:
            raise ValueError(
                "found stiffening: true with matrices, expected a mesh: geometric stiffening needs its shape functions"
            )
        return self

    @property
    def stretch(self) -> Thickness | None:
        """Stretch of a mesh of solids."""
        return self.thickness if isinstance(self.thickness, Thickness) else None

    @property
    def shells(self) -> float | dict[str, float] | None:
        """Thickness of shells, m, of all or by groups of elements; None for solids and matrices."""
        return self.thicknesses or (None if isinstance(self.thickness, Thickness) else self.thickness)

    @property
    def is_stiffened(self) -> bool:
        """True if geometric stiffening is included."""
        return self.mesh is not None and self.stiffening is not False

    @property
    def scales(self) -> tuple[float, float]:
        """Young's modulus, N/m^2, and density, kg/m^3, by which all stiffness and mass is scaled: the first material's."""
        material = self.material or next(iter((self.materials or {}).values()), None)
        return (material.E, material.density) if material else (1.0, 1.0)

    def scaled(self) -> FlexibleBody:
        """Return the body with materials in units of `scales`, on whose values its reduction does not depend."""
        modulus, density = self.scales

        def own(material: Material) -> Material:
            return material.model_copy(update={"E": material.E / modulus, "density": material.density / density})

        materials = {name: own(material) for name, material in (self.materials or {}).items()}
        return self.model_copy(
            update={"material": self.material and own(self.material), "materials": materials or None}
        )

    @property
    def files(self) -> tuple[str, ...]:
        """Names of the files of the body."""
        if isinstance(self.matrices, Matrices):
            found = self.matrices.stiffness, self.matrices.mass, self.matrices.nodes, self.matrices.rows
            return tuple(name for name in found if name is not None)
        return (self.mesh or self.matrices or "",)

    @property
    def signs(self) -> np.ndarray:
        """Signs of the coordinates, shape (3,): -1 for mirrored ones."""
        return np.array([-1.0 if axis in (self.mirror or "") else 1.0 for axis in "xyz"])

    def model(self, folder: Path) -> FiniteElements:
        """Return the checked finite element model. `folder`: folder of relative file names. Raises InputError."""
        found = self._read(folder)
        found.check()
        return mirrored(found, self.signs) if self.mirror else found

    def interfaces_on(self, model: FiniteElements) -> list[Interface]:
        """Return the interfaces on a model, which select its nodes as they are in the file. Raises InputError."""
        places, before = model.nodes * self.signs, self._as_in_the_file(model)
        found = [interface.on(name, before) for name, interface in self.interfaces.items()]
        if self.stretch is not None:
            moved = (self.stretch.moved(each.point[None], places, self.stretch.scale)[0] for each in found)
            found = [replace(each, point=point) for each, point in zip(found, moved, strict=True)]
        return [replace(each, point=each.point * self.signs) for each in found]

    def _as_in_the_file(self, model: FiniteElements) -> FiniteElements:
        """Return a model with its nodes as they are in the file, neither mirrored nor stretched."""
        places = model.nodes * self.signs
        of_file = places if self.stretch is None else self.stretch.moved(places, places, 1 / self.stretch.scale)
        return replace(model, nodes=of_file)

    def loads_on(self, model: FiniteElements) -> list[np.ndarray]:
        """Return the unit loads on each surface of a model, as `unit_loads`. Raises InputError."""
        before, found = self._as_in_the_file(model), []
        for name, surface in self.surfaces.items():
            where = f"surfaces.{name}"
            outside = None if surface.outside is None else np.array(surface.outside) * self.signs
            with prefixed(f"{where}: ", InputError):
                found.append(
                    unit_loads(model, surface.selected("selection", before), outside, float(np.prod(self.signs)))
                )
        return found

    def _read(self, folder: Path) -> FiniteElements:
        units = self.units.length, self.units.mass, self.units.time
        contents = self.contents(folder)
        if isinstance(files := self.matrices, Matrices):
            from .matrix_files import from_files

            stiffness, mass, nodes = (folder / name for name in (files.stiffness, files.mass, files.nodes))
            rows = None if files.rows is None else folder / files.rows
            names = files.stiffness_name, files.mass_name
            return from_files(stiffness, mass, nodes, rows, names, *units)
        with prefixed(f"{self.files[0]}: "):
            if self.matrices is not None:
                from .matrices import from_archive

                return from_archive(contents[0], *units)
            from .mesh import from_mesh

            stretch, materials = self.stretch, self.material or self.materials
            assert materials is not None
            return from_mesh(
                folder / self.files[0], units[0], materials,
                (lambda nodes: nodes) if stretch is None else (lambda nodes: stretch.moved(nodes, nodes, stretch.scale)),
                self.shells,
            )  # fmt: skip

    def contents(self, folder: Path) -> list[bytes]:
        """Return the contents of its files. `folder`: folder of relative file names. Raises InputError."""
        return [file_content(folder / name, "a mesh or matrices") for name in self.files]
