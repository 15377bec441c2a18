"""Count the steps of radau on the reference car over the stiffness of its bushings, from the described start and from balanced bushings.

    python -m tests.bench.solvers.preloads [--stiffness 1e6 1e7 1e8 1e9] [--rtol 1e-4]

The described poses are those of a static equilibrium with 1e7 N/m. With another stiffness the bushings do not carry the
weight, and vibrations begin. The balanced start is the state after straight driving.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np

import stiffmbs
from stiffmbs.analyses.job import prepare

from ..drives import CARS

STRAIGHT = {"sin_amp": "0", "steer_amp": "0"}
SETTLING = 3.0
"""Duration of straight driving, s."""


def counted(model: Any, rtol: float, **how: Any) -> str:
    """Return the largest initial acceleration, and the steps in the first second and in all."""
    job = prepare(model, rtol=rtol, solver="radau", **how)
    found = job.integrate()
    first = int(np.count_nonzero(found.history.t < job.grid.start + 1.0))
    return f"{np.abs(job.start.acceleration).max():.2g} m/s^2 or rad/s^2, {first} of {found.statistics['steps']} steps in the first second"


def main() -> None:
    """Print a line for each stiffness and start."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--stiffness", nargs="+", default=["1e6", "1e7", "1e8", "1e9"], help="N/m")
    parser.add_argument("--rtol", type=float, default=1e-4)
    given = parser.parse_args()
    car = CARS[0]
    for stiffness in given.stiffness:
        model, straight = (car.model("sweep", **{car.stiffness: stiffness, **more}) for more in ({}, STRAIGHT))
        settled = stiffmbs.run(straight, solver="radau", rtol=1e-6, duration=SETTLING)
        print(f"{stiffness} N/m, described: {counted(model, given.rtol)}", flush=True)
        print(f"{stiffness} N/m, balanced:  {counted(model, given.rtol, start_from=settled, start=0.0)}", flush=True)


if __name__ == "__main__":
    main()
