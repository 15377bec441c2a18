"""Bodies connected to nothing, and motions of a body that joints leave free and forces hold, or nothing holds."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from stiffmbs import spatial
from stiffmbs.analyses.check import check
from stiffmbs.analyses.run import run
from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.model.model_builder import ModelBuilder
from stiffmbs.reading.marker import Marker

from ...case import Case, Outcome, Verdict, measured, told

SEPARATE = "not connected"
FREE = "by itself"


def pendulum(*stones: str, hinged: bool = True) -> Model:
    """A bar on a hinge, and stones that nothing holds."""
    model = Model("Pendulum and stones", gravity=(0, -9.81))
    bar = model.add("bar", Body(mass=1, inertia=0.1, position=(0.5, 0)))
    if hinged:
        model.add("hinge", JOINTS["revolute"](i=bar.at(-0.5, 0), j="ground"))
    for k, name in enumerate(stones):
        model.add(name, Body(mass=1, inertia=0.1, position=(k, 1)))
    return model


def pulled(torque: str) -> Model:
    """A stone whose place a torque on the pendulum reads."""
    model = pendulum("stone")
    model.add("pull", FORCES["torque"](i="bar", torque=torque))
    return model


def requested() -> Model:
    """A stone that a request alone reads."""
    model = pendulum("stone")
    model.request("height", "stone.y")
    return model


def spun() -> spatial.Model:
    """Two bodies spun in space, with nothing else."""
    model = spatial.Model("Spun")
    for k, name in enumerate(("one", "two")):
        model.add(name, spatial.Body(mass=1, inertia=(1, 2, 3), position=(k, 0, 0), omega=(0.01, 5, 0)))
    return model


def wishbone(apart: float, about: float = 0.0, damping: float = 0.0) -> spatial.Model:
    """A suspension arm along x: a ball joint to a knuckle, and two bushings on the chassis with their stiffness about x."""
    model = spatial.Model("Wishbone", gravity=(0, 0, -9.81))
    model.add("arm", spatial.Body(mass=2, inertia=(0.01, 0.1, 0.1), position=(0.2, 0, 0)))
    model.add("knuckle", spatial.Body(mass=5, inertia=(0.1, 0.1, 0.1), position=(0.4, 0, 0.1)))
    ends = spatial.Marker(body="arm", point=(0.2, 0, 0)), spatial.Marker(body="knuckle", point=(0, 0, -0.1))
    model.add("ball", spatial.Spherical(i=ends[0], j=ends[1]))
    model.add("strut", spatial.Prismatic(i="knuckle", j=spatial.Marker(body="ground", point=(0.4, 0, 0.1))))
    for name, y in (("front", apart), ("rear", -apart)):
        on_arm, on_ground = (
            spatial.Marker(body="arm", point=(-0.2, y, 0)),
            spatial.Marker(body="ground", point=(0, y, 0)),
        )
        stiffness, dampings = (1e7, 1e7, 1e7, about, 0, 0), (0, 0, 0, damping, 0, 0)
        model.add(name, spatial.Bushing(i=on_arm, j=on_ground, stiffness=stiffness, damping=dampings))
    return model


def plate(spring: float | None = None) -> Model:
    """A plate on two rods in the plane, which turns about the point where they meet; perhaps a torsion spring holds it."""
    model = Model("Plate", gravity=(0, -9.81))
    for name, x in (("one", 0.0), ("two", 2.0)):
        bar = model.add(name, Body(mass=1, inertia=0.1, position=(x, 0)))
        model.add(f"pin_{name}", JOINTS["revolute"](i=bar.at(0, 1), j=Marker(body="ground", point=(x, 1))))
    model.add("plate", Body(mass=1, inertia=0.1, position=(1, -1)))
    for name in ("one", "two"):
        model.add(f"rod_{name}", JOINTS["distance"](i="plate", j=name, length=2**0.5))
    if spring is not None:
        model.add("spring", FORCES["torsion_spring"](i="plate", j="ground", stiffness=spring))
    return model


def _says(scene: Callable[[], ModelBuilder], about: str, names: tuple[str, ...], runs: bool = False) -> Verdict:
    """Whether `check`, or the notes of a run too, have one sentence on a matter that names these, or none."""
    found = [check(scene()).messages] + ([run(scene(), duration=1e-3, points=2).notes] if runs else [])
    for sentences in found:
        told_so = [sentence for sentence in sentences if about in sentence]
        if len(told_so) != bool(names) or not all(name in told_so[0] for name in names):
            return Verdict(Outcome.WRONG, detail=f"found {told_so}, expected {names or 'nothing'}")
    return told(next(s for s in found[0] if about in s), names) if names else measured(0.0, 0.0)


def _alone(name: str, scene: Callable[[], ModelBuilder], *names: str) -> Case:
    judge = partial(_says, scene, SEPARATE, names, runs=True)
    return Case(name, "check and run: bodies connected to nothing", judge, Outcome.TOLD if names else Outcome.RIGHT)


def _held(name: str, scene: Callable[[], ModelBuilder], *names: str) -> Case:
    judge = partial(_says, scene, FREE, names)
    return Case(name, "check: motions of one body", judge, Outcome.TOLD if names else Outcome.RIGHT)


NINE = tuple(f"stone{k}" for k in range(9))

CASES = (
    _alone("one stone beside a pendulum", partial(pendulum, "stone"), "stone"),
    _alone("nine stones beside a pendulum, all named", partial(pendulum, *NINE), *NINE),
    _alone("a stone that a request reads", requested, "stone"),
    _alone("a stone whose place a torque reads", partial(pulled, "-2*stone.x")),
    _alone("a stone whose distance a torque reads", partial(pulled, "dx(stone, bar)")),
    _alone("bodies thrown, nothing else", partial(pendulum, "stone", hinged=False)),
    _alone("bodies spun in space", spun),
    _held("wishbone on bushings apart", partial(wishbone, 0.2)),
    _held("wishbone on bushings 1 mm apart", partial(wishbone, 1e-3)),
    _held("wishbone on bushings in line with its ball", partial(wishbone, 0.0), "arm can turn", "ball", "front", "rear"),
    _held("the same, 1 N m/rad about the line", partial(wishbone, 0.0, 1.0)),
    _held("the same, a damper about the line", partial(wishbone, 0.0, 0.0, 10.0), "arm can turn"),
    _held("plate on two rods", plate, "plate can turn", "rod_one", "rod_two"),
    _held("plate on two rods and a torsion spring", partial(plate, 5.0), "would let plate turn", "spring holds"),
    _held("plate on two rods and a spring of 1e-6 N m/rad", partial(plate, 1e-6), "would let plate turn", "spring holds"),
    _held("plate on two rods and a spring without stiffness", partial(plate, 0.0), "plate can turn"),
)  # fmt: skip
