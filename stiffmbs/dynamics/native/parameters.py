"""Parameters of consistent states and of the elimination of accelerations."""

from __future__ import annotations

from dataclasses import dataclass

from ...tuning import tuned


@dataclass(frozen=True)
class ConsistencyParameters:
    """Parameters of assembly, projections, and accelerations with iterated forces and algebraic states.

    Source: tests/dynamics.
    """

    most_damped_moves: int = 200
    """Largest number of moves of a damped assembly, accepted or not."""
    nudge: float = 1e-3
    """First displacement of all bodies in a damped assembly, in sizes of the mechanism and rad. It leaves saddle points of
    the gaps."""
    close: float = 1e-6
    """Largest dimensionless gap from which Newton's moves converge."""
    most_assembly_moves: int = 50
    """Largest number of Newton's moves of an assembly."""
    most_moves: int = 20
    """Largest number of Newton's moves of a projection from a nearby state."""
    position_tolerance: float = 1e-12
    """Largest violation after a projection onto the positions, apart from rounding, m or rad. It is also the relative change
    at which algebraic states converge."""
    most_frozen_moves: int = 3
    """Largest number of moves with the factors of another state. One usually suffices nearby."""
    contraction: float = 0.01
    """Part of a violation that a move by the factors of a nearby pose may leave."""
    amplified: float = 1e6
    """Move of a projection, relative to the violation, m or rad, above which it is refused."""
    moved: float = 1e-6
    """Such a move, relative to the largest coordinate. A pose that exceeds both limits is singular up to rounding."""
    step_parts: float = 10.0
    """Step of the solver relative to that of the matrix of a stiff projection. Unstable soft forces are small there
    compared with inertia."""
    restored: float = 0.7
    """Move of a stiff projection, relative to the last one, up to which it goes on. Where stiffness and damping are equal in a
    step, the moves of either level restore half of the forces."""
    most_iterations: int = 40
    """Largest number of iterations for forces that depend on multipliers, and for algebraic states."""
    converged: float = 1e-13
    """Change of multipliers, relative to the largest multiplier or force, at which the iteration converges."""
    rounded_off: float = 1e-9
    """Change of multipliers that is accepted after the last iteration."""
    state_rounded_off: float = 1e-7
    """Change of algebraic states, relative to values or scales, that counts as rounding if it decreases slowly."""
    slow: float = 0.25
    """Ratio of successive changes of algebraic states from which on they decrease slowly."""
    zero_slope: float = 1e-10
    """Scaled derivative of an algebraic equation by its states, or scaled Newton's move, that counts as zero."""
    rate_interval: float = 1e-6
    """Interval of the difference quotient for rates of algebraic states, s. They only enter the first prediction."""
    worth_telling: float = 1e-9
    """Smallest change of the start that is reported, m, rad, m/s, rad/s."""
    much_less: float = 1e-3
    """Smallest reported part of a change (translation or rotation, or across an axis), as a fraction of the larger part."""
    large_shift: float = 0.25
    """Translation, in sizes of the mechanism, beyond which a move is no correction of a drawing."""
    large_turn: float = 45.0
    """Rotation, deg, beyond which a move is no correction of a drawing."""
    most_listed: int = 3
    """Number of bodies with the largest moves that the note of a run names."""


@dataclass(frozen=True)
class EliminationParameters:
    """Parameters of the elimination of accelerations from the block system.

    Source: tests/dynamics/test_eliminated.py, tests/dynamics/test_consistent.py.
    """

    worth_compiling: int = 10_000
    """Multiplications of the LU above which output rows and restarts use the elimination, which must be compiled."""
    most_multiplications: int = 3
    """Multiplications of the elimination, relative to an LU of the whole system, up to which it is less expensive: its
    blocks are dense and in order."""
    even: float = 100.0
    """Ratio of the square roots of inertias, in units of mass, up to which pivots reflect the geometry."""
    kept: float = 1e-3
    """Least pivot relative to its diagonal for output rows, which then lose at most three of sixteen digits."""
    lost: float = 1e-6
    """Least pivot relative to its diagonal for steps. Smaller ones require the LU with pivoting."""
    small: float = 1e-2
    """Relative size below which a pivot counts as small."""
    together: float = 1e-9
    """Least product of all small pivots. Along closed loops, losses of digits multiply; in trees, the smallest counts."""
    relative: float = 1e-5
    """The same, relative to the largest product so far."""
    residual: float = 1e-10
    """Allowed residual of accelerations, relative to the terms of J u' = gamma: forces on light bodies amplify rounding."""
    least_residual: float = 1e-9
    """Residual that is always allowed, m/s^2 or rad/s^2, times the size of mechanisms smaller than 1 m."""


CONSISTENCY = tuned("consistency", ConsistencyParameters())
ELIMINATION = tuned("elimination", EliminationParameters())
