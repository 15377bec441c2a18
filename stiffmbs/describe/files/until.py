"""Conditions that end a stage before its time: a request that comes to a value."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ..fields import Described, Measured

Number = Annotated[float, Measured("number")]
BOUNDS = ("at_least", "at_most", "equals")


class Until(Described):
    """A condition that ends a stage (Adams: SENSOR).

    Parameters
    ----------
    request : str
        Whose value is watched, over the solver's own steps.
    at_least, at_most, equals : float
        One of them: where the value comes to be that much or more, that much or less, or comes to it from either side.
    within : float
        How near to `equals` a value must come that turns round before it.
    then : str
        ``next`` goes on with the stage after it, ``stop`` ends all stages.
    """

    request: str = Field(description="name of the request that is watched")
    at_least: Number | None = Field(None, description="the stage ends where the value comes to be this or more")
    at_most: Number | None = Field(None, description="where it comes to be this or less")
    equals: Number | None = Field(None, description="where it comes to this from either side")
    within: Annotated[float, Measured("number", at_least=0)] = Field(
        0.0, description="how near to `equals` a value that turns round before it must come"
    )
    then: Literal["next", "stop"] = Field("next", description="whether the next stage follows, or none")

    @model_validator(mode="after")
    def _one_bound(self) -> Self:
        given = [name for name in BOUNDS if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(f"found {' and '.join(given) or 'no bound'}, expected one of {', '.join(BOUNDS)}")
        return self
