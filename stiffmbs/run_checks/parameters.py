"""Parameters of the checks of a run on its own motion."""

from __future__ import annotations

from dataclasses import dataclass

from ..tuning import tuned


@dataclass(frozen=True)
class RunCheckParameters:
    """Parameters of the checks of a run on its own motion.

    Source: tests/run_checks and the stress tests.
    """

    coarse: float = 1e-6
    """Largest rounding of coordinates, relative to a mechanism's size."""
    lost: float = 1e-4
    """Change of a force by the rounding of coordinates, relative to the largest force, above which a note appears."""
    roundings: int = 4
    """Number of roundings in each coordinate, for that change."""
    stiffened: float = 0.03
    """Geometric stiffness of a flexible body, relative to its elastic stiffness, from which a note appears."""
    of_second_order: float = 110.0
    """Relative error of the deflection of a flexible body, over the square of its root mean square deformation by its
    length. Source: meshes against exact beams, clamped and with a force at the end."""
    too_much: float = 0.01
    """This error from which a note appears."""
    open: float = 1e-6
    """Largest opening of a joint in sizes of the mechanism, with projection onto the constraints."""
    drifted: float = 1e-2
    """The same with drift."""
    most_instants: int = 400
    """Largest number of checked output times, and of poses to check in an interval."""
    unfollowed_part: float = 1e-2
    """Violation of a velocity equation, relative to its terms, that no tolerance explains."""
    unfollowed_velocity: float = 1e-3
    """Its minimum, m/s or rad/s."""
    poses: int = 10_000
    """Number of poses to check in the whole motion, with one for each output at least."""
    left_out: float = 10.0
    """Largest violation of dropped equations, relative to that of the others, that is due to interpolation."""
    most_assemblies: int = 500
    """Largest number of poses between outputs that are assembled."""
    uncertain_turn: float = 1.0
    """Difference of an orientation and the integral of its rate, rad, from which on the turn is uncertain."""
    overlooked_tolerances: float = 3e5
    """Velocity contradiction over a step, in tolerances, from which on an event counts as missed."""
    overlooked_part: float = 0.3
    """Velocity contradiction, relative to the larger mass-weighted acceleration times the interval, of a missed event."""
    dip: float = 0.25
    """Minimum of a parabola through the det at three outputs, relative to its ends, below which a rerun resolves it."""
    most_dips: int = 5
    """Largest number of dips to check, the deepest ones."""
    dip_instants: int = 201
    """Number of times within each."""
    magnified: float = 10.0
    """Error after the pose, as a fraction of the size, over rtol/d^2."""
    decided: float = 0.1
    """Expected error, as a fraction of the size, at which chance decides the branch."""
    worth_telling: float = 1e-3
    """The same at which it is reported."""
    last_digits: float = 1e-10
    """Smallest useful rtol, and relative rounding of lengths."""
    nearly_singular: float = 0.03
    """Smallest singular value, relative to the usual one, below which a pose counts as nearly singular."""
    takes_part: float = 0.3
    """Smallest weight, relative to the largest, of an equation that contributes to the loss of rank."""
    floor: float = 1e-14
    """Shift of squared singular values, so that factors exist at singular poses."""
    iterations: int = 8
    """Steps of inverse iteration."""
    few_rows: int = 60
    """Largest number of equations for which all singular values are computed by a dense decomposition."""
    usual_poses: int = 20
    """Number in the whole motion."""
    effort: float = 5e8
    """Largest number of operations."""
    contradicted_tolerances: float = 1e3
    """Velocity contradiction over a step, in tolerances, from which on an event counts as missed."""
    parts_of_a_run: int = 20_000
    """Number of samples over a run with Python functions, whose features are unknown."""
    parts_of_a_peak: int = 129
    """Samples around a contradiction, from which its duration follows."""
    slight: float = 0.01
    """Error of positions within a step, in tolerances, whose effect on stiff forces is tolerated."""
    slight_velocity: float = 10.0
    """The same for velocities: those in strong damping have errors of several tolerances within a step, and hardly any
    force has a narrow feature in velocities."""


RUN_CHECKS = tuned("run_checks", RunCheckParameters())
