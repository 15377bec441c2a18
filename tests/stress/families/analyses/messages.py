"""Questions at the edge of an analysis: an answer in closed form, or one sentence that names what is wrong."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from stiffmbs.analyses.equilibrium import equilibrium
from stiffmbs.analyses.linearised.transfer import transfer
from stiffmbs.model.read_scene import read_scene
from stiffmbs.studies.fit import fit
from stiffmbs.studies.sensitivities.sensitivities import sensitivities
from stiffmbs.studies.sweep import sweep

from ...variants.answers import compared, refused, said

BODY = {
    2: "bodies: {{b: {{mass: 2, inertia: 1, velocity: [{v}, 0]}}}}\n",
    3: "bodies: {{b: {{mass: 2, inertia: [1, 1, 1], velocity: [{v}, 0, 0]}}}}\n",
}
RAIL = {
    2: "joints: {rail: {type: prismatic, i: b, j: ground}}\n",
    3: "joints: {rail: {type: prismatic, i: {body: b, orientation: {z: [1, 0, 0]}}, j: {body: ground, orientation: {z: [1, 0, 0]}}}}\n",
}


def slider(dimensions: int, law: str = "", more: str = "", v: float = 0.0) -> Any:
    """Return a body of 2 kg on a rail along x, under a force, or on a rail alone."""
    zeros = ", 0" * (dimensions - 1)
    force = f"forces: {{f: {{type: force, i: b, force: ['{law}'{zeros}]}}}}\n" if law else ""
    return read_scene(f"dimensions: {dimensions}\n{BODY[dimensions].format(v=v)}{RAIL[dimensions]}{force}{more}")


def response(dimensions: int, law: str, frequency: float) -> np.ndarray:
    """Return the response of x to a force."""
    return transfer(slider(dimensions, law), ["b.fx"], ["b.x"]).response(np.array([frequency]))


def by_gravity(dimensions: int, given: str) -> float:
    """Return the error of the slope over the gravity along the rail of x(1 s), a vibration of 5 rad/s."""
    found = sensitivities(
        slider(dimensions, "-50*b.x", f"{given}run: {{duration: 1, rtol: 1e-9}}\n", 1.0), ["gravity.0"], "final(b.x)"
    )
    return abs(float(found.to["gravity.0"]) - (1 - np.cos(5)) / 25)


def found_at_rest(dimensions: int, law: str, place: float) -> float:
    """Return the distance of the equilibrium that is found from the true one."""
    return abs(float(equilibrium(slider(dimensions, law)).channels["b.x"]) - place)


def notes_at_rest(dimensions: int, law: str) -> str:
    """Return the notes of an equilibrium."""
    return "; ".join(equilibrium(slider(dimensions, law)).notes)


def fitted(dimensions: int, low: float, high: float) -> str:
    """Return the message of a fit of the stiffness to a vibration of 5 rad/s: k = 50."""
    t = np.linspace(0, 1, 30)
    scene = slider(dimensions, "-k*b.x", "parameters: {k: 45}\nrun: {duration: 1}\n", v=1.0)
    return fit(scene, {"time": t, "b.x": np.sin(5 * t) / 5}, {"k": (low, high)}).message


FREE, OWN = "found 0 Hz", "found 0.795775 Hz, the frequency of an undamped m"
PARAMETERS = "parameters: {k: 45, c: 2}\nrun: {duration: 0.1}\n"

CASES = (
    *(
        refused(f"response of '{law or 'no force'}' at {frequency:.4g} Hz in {dimensions}D", "no such response", partial(response, dimensions, law, frequency), words)
        for dimensions, law, frequency, words in (
            (2, "", 0.0, FREE), (3, "", 0.0, FREE), (2, "-6*b.vx", 0.0, FREE), (3, "-6*b.vx", 0.0, FREE),
            (2, "-50*b.x", 5 / (2 * np.pi), OWN), (3, "-50*b.x", 5 / (2 * np.pi), OWN),
        )
    ),
    *(
        compared(f"gravity.0 of '{given.strip() or 'no gravity'}' in {dimensions}D", "(1 - cos(5 t))/25", partial(by_gravity, dimensions, given), 1e-6)
        for dimensions, given in ((2, ""), (2, "gravity: [0, 0]\n"), (3, "gravity: [0, 0, 0]\n"), (3, "gravity: [0, 0, -9.81]\n"))
    ),
    *(
        compared(f"equilibrium of {law} in {dimensions}D", "the root of the force", partial(found_at_rest, dimensions, law, place), allowed)
        for dimensions, law, place, allowed in (
            (2, "-b.x^3", 0.0, 1e-3), (3, "-b.x^3", 0.0, 1e-3), (2, "-(b.x - 0.1)^3", 0.1, 0.05), (3, "-b.x^5", 0.0, 0.1), (2, "8 - b.x^3", 2.0, 1e-6),
        )
    ),
    *(
        said(f"slider under the force {law or 'of nothing'} in {dimensions}D", "it is named", partial(notes_at_rest, dimensions, law), "no force determines b.vx")
        for dimensions, law in ((2, "0"), (3, ""), (2, "-3*b.vx"))
    ),
    *(
        said(f"fit within [{low:g}, {high:g}] in {dimensions}D", "the bound", partial(fitted, dimensions, low, high), *words, without=("bound",) * (not words))
        for dimensions, low, high, words in (
            (2, 40.0, 48.0, ("'k'", "upper bound, 48")), (3, 55.0, 90.0, ("'k'", "lower bound, 55")), (2, 20.0, 90.0, ()), (3, 40.0, 70.0, ()),
        )
    ),
    *(
        refused(f"study of the unknown {name} in {dimensions}D", "the parameters that there are", partial(sweep, slider(dimensions, "-k*b.x", PARAMETERS), {name: [1.0]}), f"{name}: found no such parameter", "expected one of ", "k")
        for dimensions, name in ((2, "kk"), (3, "stiffness"), (2, "K"))
    ),
)  # fmt: skip
