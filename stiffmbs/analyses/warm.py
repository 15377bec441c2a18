"""Derivation and compilation ahead of first runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from pathlib import Path
from typing import Any

from ..compile.compile_model import kinds_of
from ..compile.kind import Kind
from ..compile.machine.routines import compile_unit, fully_compiled, units
from ..compile.record import compile_kind
from ..elements.body import Body
from ..elements.element import Joint
from ..elements.joints.prismatic import Prismatic
from ..elements.joints.revolute import Revolute
from ..elements.samples import Samples
from ..errors import StiffmbsError
from ..model.model import Model
from ..model.model_builder import ModelBuilder
from ..model.parts.options import CHOOSE, OPTIONS, choices_of
from ..presolve.reduced_model import ReducedModel
from ..presolve.spinning_bodies import AXES
from ..processes import process_pool
from ..reading.files.text_file import file_text
from ..reading.files.yaml_text import read_yaml
from .job import prepare
from .load_scene import load_scene


def warm(scenes: Sequence[Path], watch: Callable[[int, int], None]) -> list[str]:
    """Compile the routines of all solvers, all kinds of elements in their usual forms, and those of scenes.

    All processors are used. Other formulas in a scene form kinds of their own, which are compiled on first use.

    Parameters
    ----------
    scenes : sequence of Path
        Scene files; each is compiled with all words of its options.
    watch : callable
        Called with the numbers of completed and of all tasks known so far.

    Returns
    -------
    list of str
        A sentence for each scene that cannot be read or assembled.
    """
    with process_pool() as processes:
        waiting: set[Future[Any]] = {processes.submit(compile_unit, unit) for unit in units()}
        known = usual_kinds()
        waiting |= {processes.submit(compile_kind, kind) for kind in known}
        of_scenes = {processes.submit(kinds_of_scene, path): path for path in scenes}
        waiting |= set(of_scenes)
        total, faults = len(waiting), []
        while waiting:
            done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            for task in done:
                kinds, found_faults = task.result() if task in of_scenes else ((), [])
                faults += found_faults
                new = [kind for kind in kinds if kind not in known]
                known = (*known, *new)
                waiting |= {processes.submit(compile_kind, kind) for kind in new}
                total += len(new)
            watch(total - len(waiting), total)
    return faults


@fully_compiled()
def kinds_of_scene(path: Path) -> tuple[tuple[Kind, ...], list[str]]:
    """Return the kinds of elements of a scene, with each word of its options in turn, and sentences on what cannot be assembled.

    They are those of the scene as it is described, and after presolve.
    """
    kinds: dict[Kind, None] = {}
    faults: list[str] = []
    try:
        every = ((), *_other_words(path))
    except StiffmbsError as error:
        return (), [str(error)]
    for changes in every:
        try:
            scene = load_scene(path, changes)
            job = prepare(scene)
        except StiffmbsError as error:
            faults.append(str(error))
            continue
        kinds |= dict.fromkeys(kinds_of(scene))
        for dynamics in (job.dynamics, *(part.dynamics for part in job.subsystems)):
            kinds |= dict.fromkeys(group.kind for group in dynamics.system.groups)
    return tuple(kinds), faults


def _other_words(path: Path) -> Iterator[tuple[tuple[str, str]]]:
    """Yield changes of a scene file that choose each word of its options but the first."""
    if path.suffix.lower() not in (".yaml", ".yml"):
        return
    found = read_yaml(file_text(path), str(path))
    for name, words in choices_of(found if isinstance(found, dict) else {}, OPTIONS).items():
        for word in list(words)[1:]:
            yield ((f"{CHOOSE}.{name}", word),)


def usual_kinds() -> tuple[Kind, ...]:
    """Return the usual kinds of elements, and joints of bodies whose quaternions do not follow their spin."""
    models = [usual_elements(dimensions).data() for dimensions in (2, 3)]
    bearings = usual_bearings().data()
    spun = [ReducedModel(bearings, bearings.bodies, axes={"a": axis}) for axis in AXES]
    return tuple(dict.fromkeys(kind for model in (*models, *spun) for kind in kinds_of(model)))


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
