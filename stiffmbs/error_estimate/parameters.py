"""Parameters of the estimate of the error of a run."""

from __future__ import annotations

from dataclasses import dataclass

from ..tuning import tuned


@dataclass(frozen=True)
class EstimateParameters:
    """Parameters of the estimate of the error of a run.

    Source: ``python -m tests.stress.self_assessment``.
    """

    work: float = 1e6
    """Evaluations of the equations times unknowns up to which every run estimates its error, in about 0.2 s."""
    row: float = 50.0
    """Work at a step (of radau: at a point of a step) that does not depend on the unknowns, in the same unit; about 10 us."""
    solution: float = 2.0
    """Further work there for n unknowns, in n^1.5: the growth of factors with little fill-in."""
    restart: float = 2.5e4
    """Work at a restart, in the same unit; about 5 ms."""
    events: int = 100
    """Number of restarts after events that every run estimates beyond this work, in about 0.5 s: their errors add up."""
    difference: float = 1e-7
    """Displacements by which the equations are linearised, relative to the size of the mechanism."""
    beside: float = 1e-3
    """Distance from an event within which the equations are not linearised, in lengths of the piece that it ends or starts."""
    close: float = 1e-2
    """Explicit step in its longer neighbour below which a jump of values in it is that of an event, and no error."""
    points: int = 6
    """Accepted states on the polynomial that gives the states within a step of bdf."""
    uneven: float = 10.0
    """Ratio of the steps on that polynomial above which the ends of the step give them."""
    converged: float = 1e-4
    """Last correction of an iteration for the change of an error over a step, relative to this change."""
    smooth: float = 0.1
    """Error of the quadrature over a step of radau, relative to the largest local error, above which it is adaptive."""
    isolated: float = 0.25
    """Largest part of the steps whose quadrature is adaptive. If more seem to have kinks, these are rounding of stiff forces."""
    intervals: float = 2.0
    """Largest number of intervals that adaptive quadrature halves, in rows of the piece."""
    uncertain: float = 0.03
    """Part of the estimated errors by which they may be too small for a contact within the error to be found."""
    lost: float = 0.05
    """Error of a pose, rad or relative to the size of the mechanism, above which the linear estimate is lost."""
    tolerances: float = 100.0
    """Error of a position relative to its size, in relative tolerances, above which a note appears."""
    second: float = 0.1
    """Tolerance of the second run by which the errors of explicit steps are estimated, in that of the run. It takes a third more
    steps; its own errors, about as small a part, are in the estimate. Beyond `smallest_rtol` the inverse."""
    shared: float = 0.05
    """Part of the run in steps that the second run takes too, above which another one takes shorter steps there."""
    large: float = 0.01
    """Error of any channel relative to its size above which a note appears."""
    part: float = 1e-2
    """First relative tolerance of a run that is to reach an accuracy, in the relative error asked for; also the factor of
    the next one if the error is unknown."""
    smallest_rtol: float = 1e-13
    """Smallest relative tolerance that is tried."""
    aim: float = 0.5
    """Part of the error asked for at which the next tolerance aims."""
    slope: float = 0.75
    """Exponent of the tolerance in the error of bdf."""
    numbers_at_once: int = 4_000_000
    """Numbers in the matrices that are in memory at once, 32 MB."""


ESTIMATE = tuned("error_estimate", EstimateParameters())
