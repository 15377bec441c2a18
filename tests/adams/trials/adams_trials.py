"""How datasets are run and held against `adams_oracle`."""

import numpy as np

import stiffmbs

from .adams_oracle import rotation

HEAD = """a trial
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
"""


def played(folder, text, duration=1.0, head=HEAD, rtol=1e-8, step=0.02):
    """Solution of a dataset that is written to a file and run as a user would."""
    path = folder / "trial.adm"
    path.write_text(head + text + "\nEND\n")
    return stiffmbs.run(stiffmbs.load_scene(path), duration=duration, output=step, rtol=rtol)


def table(solution, element, names="fx fy fz tx ty tz"):
    """Channels of an element side by side, (t, n)."""
    return np.column_stack([solution.channels[f"{element}.{name}"] for name in names.split()])


def turns(solution, body):
    return np.array([rotation(q) for q in table(solution, body, "q0 q1 q2 q3")])


def near(found, wanted, tolerance, scale=None):
    """Whether two histories agree to a tolerance of the larger one's peak, told with the worst place."""
    found, wanted = np.asarray(found), np.asarray(wanted)
    assert found.shape == wanted.shape
    scale = scale or max(np.abs(wanted).max(), 1e-3)
    worst = np.abs(found - wanted).max() / scale
    assert worst < tolerance, f"{worst:.1e} of {scale:.3g} apart, at row {np.abs(found - wanted).argmax()}"


def moves_alike(solution, body, wanted, tolerance=2e-7):
    """Whether a body's position, orientation, velocities and accelerations are those of `History.part`."""
    for names, slack in (("x y z", 1), ("vx vy vz", 5), ("wx wy wz", 5), ("ax ay az", 50), ("wdx wdy wdz", 50)):
        near(table(solution, body, names), np.column_stack([wanted[n] for n in names.split()]), slack * tolerance)
    near(turns(solution, body), wanted["turn"], 5 * tolerance)
