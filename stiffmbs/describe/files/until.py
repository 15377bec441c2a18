"""Conditions on the value of a request that end a stage or change its course."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ..fields import Described, Measured
from ..units import si

Number = Annotated[float, Measured("number")]
BOUNDS = ("at_least", "at_most", "equals")


class Until(Described):
    """Condition that ends a stage or changes its course (Adams: SENSOR).

    Parameters
    ----------
    request : str
        Request whose value is monitored over the solver's internal steps.
    at_least, at_most, equals : float
        Exactly one: the condition is met when the value rises to it, falls to it, or reaches it from either side.
    within : float
        Tolerance for an extremum of the value that does not quite reach `equals`, and hysteresis: the distance by which
        the value must move back before the condition can be met again.
    then : str
        ``next`` continues with the next stage, ``stop`` ends all stages, ``on`` continues this stage.
    output : float, optional
        Time between output points from then on, s; with ``on``.
    sets : mapping of str to str
        Inputs that are set to the value that a request has at that time.
    """

    request: str = Field(description="name of the request that is watched")
    at_least: Number | None = Field(None, description="the stage ends where the value comes to be this or more")
    at_most: Number | None = Field(None, description="where it comes to be this or less")
    equals: Number | None = Field(None, description="where it comes to this from either side")
    within: Annotated[float, Measured("number", at_least=0)] = Field(
        0.0,
        description="how near to `equals` a value that turns round before it must come, and how far back before it counts again",
    )
    then: Literal["next", "stop", "on"] = Field(
        "next", description="whether the next stage follows, none, or this one goes on"
    )
    output: si.PositiveTime | None = Field(None, description="time between output points from there on, s; with on")
    sets: dict[str, str] = Field(default_factory=dict, description="inputs that take the value of a request there")

    @model_validator(mode="after")
    def _one_bound(self) -> Self:
        given = [name for name in BOUNDS if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(f"found {' and '.join(given) or 'no bound'}, expected one of {', '.join(BOUNDS)}")
        if self.output is not None and self.then != "on":
            raise ValueError("found an output of a condition that ends the stage, expected then: on")
        return self
