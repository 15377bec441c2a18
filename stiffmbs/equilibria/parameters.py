"""Parameters of the search for equilibria and of the balance of forces."""

from __future__ import annotations

from dataclasses import dataclass

from ..tuning import tuned


@dataclass(frozen=True)
class EquilibriumParameters:
    """Parameters of the search for equilibria and of the balance of forces.

    Source: tests/equilibria.
    """

    most_moves: int = 2000
    """Largest number of moves of a search."""
    most_straight_moves: int = 200
    """Largest number of moves of a search for a straight motion, after which one that turns is sought."""
    translation: float = 0.25
    """Longest move of a body, relative to the mechanism's size (Adams: EQUILIBRIUM/TLIMIT)."""
    rotation: float = 0.5
    """Longest rotation of a body in a move, rad (ALIMIT)."""
    least_shift: float = 1e-3
    """Lower bound of sqrt(s), rad/s, which keeps free directions in place."""
    largest_shift: float = 1e15
    """Upper bound of sqrt(s), rad/s."""
    shift_falls: float = 0.1
    """Least factor of s after a step."""
    shift_rises: float = 4.0
    """Factor of s after a rejected step."""
    wanted_ratio: float = 0.1
    """Ratio of Newton's moves for which s is chosen."""
    last_move: float = 0.05
    """Move that ends a step, relative to its length."""
    diverging_move: float = 0.6
    """Move that rejects a step, relative to its length."""
    most_corrections: int = 8
    """Largest number of corrections in a step."""
    worth_another_move: float = 0.5
    """Largest residual ratio of a polishing move that counts as convergence."""
    most_misses: int = 2
    """Successive polishing moves without convergence that are allowed; after more, rounding governs."""
    balanced: float = 1e-10
    """Imbalance that counts as zero, relative to the largest force."""
    rounding: int = 8
    """Roundings of the coordinates that are allowed in the forces."""
    slowest: float = 1e-5
    """Rate, rad/s. A force is negligible if it moves its body by less than the mechanism's size, or 1 rad, in 1/slowest."""
    slow_state: float = 1e-3
    """Rate of a state relative to itself, 1/s, that scales the allowed residual of its equation."""
    passed_on: float = 1e-8
    """Largest allowed rounding transmitted by joints from other bodies, relative to the largest force."""
    other_speed: float = 0.5
    """Difference of the speed that forces determine from that of the description, relative to it, above which a note appears."""
    most_nearest_moves: int = 100
    """Largest number of moves to the nearest equilibrium."""
    most_halvings: int = 12
    """Largest number of halvings of such a move."""
    halvings: int = 10
    """Halvings of a step towards either end, at which forces are compared with those at the ends."""
    sections: int = 25
    """Golden sections around the largest of these forces."""
    pole: float = 1e3
    """Force within a step, relative to the largest at its ends, that rejects the step."""
    no_effect: float = 1e-9
    """Relative effect of a velocity on forces, rates or constraints, and residual of a linear system, that count as zero;
    also the rank tolerance of spins."""


EQUILIBRIA = tuned("equilibria", EquilibriumParameters())
