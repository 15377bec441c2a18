"""Road by tables."""

from __future__ import annotations

from pydantic import Field, ValidationInfo, field_validator, model_validator

from ...reading.did_you_mean import instead_of
from ...reading.table import Table
from ...reading.units import si
from ..element import Component, Expr, Symbolic
from .road import Road, clipped
from .rolling_filter import through_filter


class TableRoad(Road):
    """Road with a table over x for its height, or two tables for the tracks of left and right wheels.

    Between the tracks, at y = track/2 and -track/2, the height is interpolated by a cubic with zero slope at both ends;
    beyond them it is that of the nearer track.
    """

    kind = "table"

    profile: Table | None = Field(None, description="height over x, m, for all y; a table or its name")
    left: Table | None = Field(None, description="height over x at y >= track/2, m")
    right: Table | None = Field(None, description="height over x at y <= -track/2, m")
    track: si.PositiveLength | None = Field(None, description="distance between the left and right tracks, m")

    @field_validator("profile", "left", "right", mode="before")
    @classmethod
    def _by_name(cls, found: object, info: ValidationInfo) -> object:
        if not isinstance(found, str):
            return found
        tables = (info.context or {}).get("tables") or {}
        if found not in tables:
            raise ValueError(f"found the unknown table '{found}'{instead_of(found, tables)}")
        return tables[found]

    @model_validator(mode="after")
    def _one_or_two(self) -> TableRoad:
        two = (self.left, self.right, self.track)
        if (self.profile is None) == (None in two) or (self.profile is not None and two != (None, None, None)):
            given = [name for name in ("profile", "left", "right", "track") if getattr(self, name) is not None]
            raise ValueError(
                f"found {' and '.join(given) or 'no table'}, expected either 'profile', or 'left', 'right' and 'track'"
            )
        return self

    def extent(self) -> tuple[float, float]:
        tables = [table.table for table in (self.profile, self.left, self.right) if table is not None]
        return min(table[0][0] for table in tables), max(table[-1][0] for table in tables)

    def in_equations(self) -> dict[str, object]:
        """Return its tables, filtered with `filter_radius`."""
        own = dict(Component.in_equations(self))
        del own["filter_radius"]
        filtered = {
            name: own[name] and through_filter(own[name], self.filter_shape) for name in ("profile", "left", "right")
        }
        return {**own, **filtered}

    @staticmethod
    def height(r: Symbolic, x: Expr, y: Expr) -> Expr:
        return r.profile(x) if r.profile is not None else two_tracks(r, x, y)


def two_tracks(r: Symbolic, x: Expr, y: Expr) -> Expr:
    """Return the height of a road with tables `left` and `right`, a `track` apart."""
    s = clipped((2 * y / r.track + 1) / 2)
    right, left = r.right(x), r.left(x)
    return right + (left - right) * s**2 * (3 - 2 * s)
