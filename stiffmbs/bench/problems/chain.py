"""Chains of 10 and 100 pinned rods let go from the horizontal, 2 s with 201 output points: nothing in them is stiff."""

from __future__ import annotations

from typing import Any

from ...describe.model import ModelData
from ...describe.scene import read_scene
from ...show.run import prepare
from ..measure import Contestant

SCENE = """
name: Chain
parameters: {N: LINKS, L: 0.1 m}
gravity: [0, -9.81]
bodies:
  link{k}: {for: k in 1..N, mass: 0.1 kg, inertia: 0.1 kg*L^2/12, position: [(k - 0.5)*L, 0]}
joints:
  pin1: {type: revolute, i: {body: link1, point: [-L/2, 0]}, j: ground}
  pin{k}:
    for: k in 2..N
    type: revolute
    i: {body: "link{k}", point: [-L/2, 0]}
    j: {body: "link{k-1}", point: [L/2, 0]}
run: {duration: 2, points: 201}
"""
LAST_AT_END = {10: (0.383878994719, -0.200667490192), 100: (-7.572975444743, -5.793758739116)}
"""Where the centre of the last rod is after 2 s: dop853 and dopri5 at rtol 1e-14 and 1e-12 agree to 2e-11."""


def chain(links: int) -> ModelData:
    """The chain of so many rods."""
    return read_scene(SCENE.replace("LINKS", str(links)))


def compiled(scene: ModelData, links: int, name: str, **changes: Any) -> Contestant:
    """The integration of the compiled chain; its error is that of the last rod's place at the end."""
    job = prepare(scene, **changes)
    expected = LAST_AT_END[links]

    def solve() -> float:
        x, y, _ = job.integrate().q[-1, -3:]
        return max(abs(x - expected[0]), abs(y - expected[1]))

    return Contestant(name, f"{links} links, rtol {job.settings.rtol:g}", False, solve)


def contestants() -> list[Contestant]:
    """The explicit integrator of order 8 against bdf."""
    found = []
    for links, of_bdf, of_explicit in ((10, 1e-8, (1e-6, 1e-8)), (100, 1e-6, (1e-4, 1e-6))):
        scene = chain(links)
        found.append(compiled(scene, links, "bdf", rtol=of_bdf))
        for rtol in of_explicit:
            found.append(compiled(scene, links, "dop853", solver="projected", scheme="dop853", rtol=rtol))
    return found
