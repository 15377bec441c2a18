"""Solutions as pandas tables and xarray data sets."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING

from ..errors import InputError

if TYPE_CHECKING:
    import pandas
    import xarray

    from .solution import Solution


def data_frame(solution: Solution) -> pandas.DataFrame:
    """Return a table; see `Solution.to_pandas`."""
    _refuse_missing("pandas", "pip install pandas")
    import pandas

    frame = pandas.DataFrame(solution.channels, index=pandas.Index(solution.time, name="time"))
    frame.attrs = {"name": solution.name, "units": {"time": "s", **solution.units}}
    return frame


def data_set(solution: Solution) -> xarray.Dataset:
    """Return a data set; see `Solution.to_xarray`."""
    _refuse_missing("xarray", "pip install 'stiffmbs[netcdf]'")
    import xarray

    variables = {}
    for name, values in solution.channels.items():
        unit = solution.unit(name)
        known = {"channel": name, "unique": int(name not in solution.not_unique), **({"units": unit} if unit else {})}
        variables[name] = ("time", values, known)
    about = {"title": solution.name, "outcome": solution.outcome.name, "message": solution.message}
    time = xarray.Variable("time", solution.time, {"units": "s"})
    return xarray.Dataset(variables, coords={"time": time}, attrs=about)


def _refuse_missing(package: str, remedy: str) -> None:
    if find_spec(package) is None:
        raise InputError(f"found no {package}, expected it installed: {remedy}")
