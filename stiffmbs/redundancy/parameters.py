"""Parameters of rank decisions, of assembled poses and of the choice of redundant equations."""

from __future__ import annotations

from dataclasses import dataclass

from ..tuning import tuned


@dataclass(frozen=True)
class RedundancyParameters:
    """Parameters of rank decisions, of assembled poses and of the choice of redundant equations.

    Source: tests/redundancy and the stress tests of structure.
    """

    dependent: float = 1e-8
    """Singular value, or determinant of the Gram matrix, of normalised rows below which they are dependent."""
    closed: float = 1e-11
    """Largest violation of an assembled pose, relative to the loop's size."""
    agrees: float = 1e-6
    """Largest violation of an assembled pose with redundant equations of limited precision."""
    most_steps: int = 40
    """Largest number of steps of an assembly."""
    longest_step: float = 1.0
    """Longest step (arms, rad), so that assembly stays near the described pose."""
    rounding: float = 1e-9
    """Slope of |C| relative to |C|, norm of a row relative to the others, and direction, below which they count as zero."""
    least_damping: float = 1e-13
    """Smallest damping, which keeps C_q C_q^T regular with redundant equations."""
    sound: float = 1e-5
    """Smallest singular value of the scaled J above which the equations are clearly independent.
    A pose with singular values between `dependent` and this one is nearly singular. Relative to the least value in
    general, it is the bound of a singular start."""
    by_gap: float = 30.0
    """Bound of redundancy in gaps of the start, for equations of limited precision."""
    poses: int = 3
    """Number of poses that confirm the rank."""
    perturbation: float = 0.1
    """Their distance from the start, arms and rad."""
    shrinks: int = 5
    """Number of reductions of that distance."""
    clearly_regular: float = 1e-3
    """Singular value above which the singular vectors of a large matrix are not computed."""
    more: int = 10
    """Additional vectors of the subspace iteration."""
    shift: float = 1e-10
    """Shift of J J^T. Each iteration reduces vectors of singular values above `clearly_regular` by
    shift/clearly_regular^2."""
    iterations: int = 4
    """Number of subspace iterations."""
    same_direction: float = 1e-5
    """Largest angle, rad, and relative perpendicular component of a force, for which directions count as equal."""
    well_chosen: float = 0.1
    """Smallest share of a dropped row in the null spaces, relative to the largest, unless no other row remains."""
    takes_part: float = 1e-6
    """Share in a combination, relative to its largest, below which a row is not part of it."""
    independent_component: float = 1e-3
    """Smallest singular value of independent components, relative to the largest reaction."""
    most_joints: int = 10
    """Largest number of joints to choose from, the last ones."""
    most_changed: int = 4
    """Largest number of joints to change at once."""
    most_trials: int = 2000
    """Largest number of choices to try."""
    instants: tuple[float, ...] = (0.0137, 0.0931, 0.2113, 0.3719, 0.6131, 0.8677, 0.9941)
    """Times of the check of time-dependent scenes, as fractions of the run."""
    nearly: float = 1e-3
    """Largest violation at which equations count as redundant apart from their disagreement."""
    independent_row: float = 0.2
    """Smallest component of a row of J perpendicular to others, relative to its norm, that makes it clearly independent."""
    longest_move: float = 20.0
    """Largest displacement that satisfies the other equations, in gaps, for which the gap counts as a contradiction."""
    stride: float = 0.2
    """Longest displacement (arms, rad) between two poses, to stay on one branch."""
    most_strides: int = 150
    """Largest number of these poses."""
    stiffness_rounding: float = 1e-12
    """Stiffness that counts as rounding, relative to the largest on the body."""
    further: float = 0.3
    """Displacement along a free motion to a pose at which the stiffness of forces is checked again."""
    samples: int = 4
    """Number of random states and times at which forces are compared, so that no gain is zero at all of them."""
    most_names: int = 6
    """Largest number of joints that a message names."""


REDUNDANCY = tuned("redundancy", RedundancyParameters())
