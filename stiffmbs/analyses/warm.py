"""Derivation and compilation ahead of first runs."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator

from ..compile.compile_model import kinds_of
from ..compile.kind import Kind
from ..compile.machine.routines import Routine, fully_compiled
from ..compile.record import compile_usual
from ..elements.body import Body
from ..elements.element import Joint
from ..elements.joints.prismatic import Prismatic
from ..elements.joints.revolute import Revolute
from ..elements.samples import Samples
from ..model.model import Model
from ..model.model_builder import ModelBuilder
from ..presolve.reduced_model import ReducedModel
from ..presolve.spinning_bodies import AXES
from ..processes import process_pool


@fully_compiled()
def warm() -> None:
    """Compile all kinds of elements in their usual forms, bearings of spinning bodies, and the routines of all solvers.

    Formulas in a scene form kinds of their own, which are compiled on first use, like code that a single formulation
    uses.
    """
    with process_pool() as processes:
        list(processes.map(compile_usual, usual_kinds()))
    for routine in routines():
        routine.call  # noqa: B018 is loaded by being asked for


def usual_kinds() -> tuple[Kind, ...]:
    """Return the usual kinds of elements, and joints of bodies whose quaternions do not follow their spin."""
    models = [usual_elements(dimensions).data() for dimensions in (2, 3)]
    bearings = usual_bearings().data()
    spun = [ReducedModel(bearings, bearings.bodies, axes={"a": axis}) for axis in AXES]
    return tuple(dict.fromkeys(kind for model in (*models, *spun) for kind in kinds_of(model)))


def routines() -> Iterator[Routine]:
    """Yield every compiled routine that a module of the package declares."""
    for name in ("compile", "dynamics", "solve", "sensitivity_equations", "results", "run_checks"):
        package = importlib.import_module(f"stiffmbs.{name}")
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if ".native." not in f"{module.name}.":
                found = vars(importlib.import_module(module.name)).values()
                yield from (value for value in found if isinstance(value, Routine))


BODIES = ("a", "b", "c")


def usual_elements(dimensions: int) -> ModelBuilder:
    """Return a model of all forms of all kinds, including registered user-defined ones; it is compiled, never solved."""
    model = _in_plane() if dimensions == 2 else _in_space()
    joints = dict(model.joints)
    samples = Samples(lambda k: BODIES[k], joints)
    for kinds in model.kinds:
        for kind, element in kinds.items():
            for k, form in enumerate(element.forms):
                model.add(f"{kind}_{k}", samples.made(element, form))
    return model


def usual_bearings() -> ModelBuilder:
    """Return a spatial model of all joints in which body ``a`` may spin freely, relative to another body."""
    from ..elements.spatial.joints.cylindrical import Cylindrical
    from ..elements.spatial.joints.revolute import Revolute
    from ..elements.spatial.joints.spherical import Spherical

    model = _bodies_in_space()
    for bearing in (Revolute, Cylindrical, Spherical):
        for i, j in (("a", "b"), ("b", "a")):
            model.add(f"{bearing.kind}_{i}_{j}", bearing(i=i, j=j))  # type: ignore[arg-type]
    return model


def _in_plane() -> ModelBuilder:
    model = Model(gravity=(0, -9.81))
    for k, name in enumerate(BODIES):
        model.add(name, Body(mass=1, inertia=1, position=(k, 0)))
    _add_joints(model, Revolute, Prismatic)
    return model


def _in_space() -> ModelBuilder:
    from ..elements.spatial.joints.cylindrical import Cylindrical
    from ..elements.spatial.joints.prismatic import Prismatic
    from ..elements.spatial.joints.revolute import Revolute
    from ..elements.spatial.joints.spherical import Spherical

    model = _bodies_in_space()
    _add_joints(model, Revolute, Prismatic)
    model.add("ball", Spherical(i="a", j="ground"))  # type: ignore[arg-type]
    model.add("sleeve", Cylindrical(i="a", j="ground"))  # type: ignore[arg-type]
    return model


def _bodies_in_space() -> ModelBuilder:
    from ..elements.spatial.body import Body
    from ..model.spatial_model import Model

    model = Model(gravity=(0, 0, -9.81))
    for k, name in enumerate(BODIES):
        model.add(name, Body(mass=1, inertia=(1, 1, 1), position=(k, 0, 0)))
    return model


def _add_joints(model: ModelBuilder, revolute: type[Joint], prismatic: type[Joint]) -> None:
    """Add joints that other elements refer to."""
    model.add("pin", revolute(i="a", j="ground"))
    model.add("second_pin", revolute(i="b", j="ground"))
    model.add("slider", prismatic(i="c", j="ground"))
    model.add("second_slider", prismatic(i="b", j="ground"))
