"""Conditions that end a stage before its time, or change how it goes on: a request that comes to a value."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ..fields import Described, Measured
from ..units import si

Number = Annotated[float, Measured("number")]
BOUNDS = ("at_least", "at_most", "equals")


class Until(Described):
    """A condition that ends a stage, or changes how it goes on (Adams: SENSOR).

    Parameters
    ----------
    request : str
        Whose value is watched, over the solver's own steps.
    at_least, at_most, equals : float
        One of them: where the value comes to be that much or more, that much or less, or comes to it from either side.
    within : float
        How near to `equals` a value must come that turns round before it; how far a value must go back before it counts again.
    then : str
        ``next`` goes on with the stage after it, ``stop`` ends all stages, ``on`` goes on with this stage.
    output : float, optional
        Time between output points from there on, s; with ``on``.
    sets : mapping of str to str
        Inputs that have the value from there on which a request has there.
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
