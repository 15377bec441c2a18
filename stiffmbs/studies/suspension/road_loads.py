"""Road loads: forces and torques of all bushings in their own axes, with their peaks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...analyses.job import Runnable, data_of
from ...elements.spatial.elastic import Elastic
from ...errors import InputError
from ...model.model_data import ModelData
from ...reading.marker import GROUND
from ...results.marker_motion import Measures, dot
from ...results.solution import Solution

COMPONENTS = ("fx", "fy", "fz", "tx", "ty", "tz")


@dataclass(frozen=True)
class Peak:
    """Largest magnitude of a component."""

    component: str  # fx to tz, along the axes of the bushing's marker j
    value: float  # signed value, N or N m
    time: float  # time, s
    case: str  # load case


@dataclass(frozen=True)
class RoadLoads:
    """Loads of bushings.

    Attributes
    ----------
    peaks : dict of str to tuple of Peak
        Peaks of the six components of each bushing.
    loads : dict of str to dict of str to ndarray
        Series by case and by channel such as ``arm.bush.fx``, in the bushing's own axes.
    """

    peaks: dict[str, tuple[Peak, ...]]
    loads: dict[str, dict[str, np.ndarray]]

    def as_dict(self) -> dict[str, object]:
        """Return the peaks for JSON: value, time and case by bushing and component."""
        return {
            name: {peak.component: {"value": peak.value, "time": peak.time, "case": peak.case} for peak in peaks}
            for name, peaks in self.peaks.items()
        }


def road_loads(model: Runnable, cases: Mapping[str, Solution]) -> RoadLoads:
    """Return the forces and torques of all bushings, along the axes of their markers j, in runs of a model.

    Parameters
    ----------
    model : Model, Scene, str or Path
        Spatial model.
    cases : mapping of str to Solution
        Runs of the model by the names of load cases.

    Returns
    -------
    RoadLoads
        Forces on marker i's body, at its point.

    Raises
    ------
    InputError
        If there is no case, or a run does not belong to the model.
    """
    data = data_of(model)
    names = [name for name, force in data.forces.items() if isinstance(force, Elastic)]
    if not cases or data.dimensions != 3:
        raise InputError(
            f"found {len(cases)} load cases in {data.dimensions} dimensions, expected one or more in space"
        )
    loads = {case: _in_own_axes(data, names, case, solution) for case, solution in cases.items()}
    peaks = {name: tuple(_peak(f"{name}.{part}", part, loads, cases) for part in COMPONENTS) for name in names}
    return RoadLoads(peaks, loads)


def _in_own_axes(model: ModelData, names: list[str], case: str, solution: Solution) -> dict[str, np.ndarray]:
    found: dict[str, np.ndarray] = {}
    counters: dict[str, np.ndarray] = {}
    measures = Measures(model, solution.__getitem__, counters.__getitem__, np)
    for name in names:
        marker = model.forces[name].j  # type: ignore[attr-defined]
        needed = [f"{name}.{part}" for part in COMPONENTS]
        needed += [] if marker.body == GROUND else [f"{marker.body}.q{k}" for k in range(4)]
        for channel in needed:
            if channel not in solution:
                raise InputError(f"{case}: found no channel '{channel}', expected a run of this model")
        axes = measures.marker(marker).axes
        for kind in "ft":
            x, y, z = (solution[f"{name}.{kind}{axis}"] for axis in "xyz")
            found |= {f"{name}.{kind}{axis}": dot(own, (x, y, z)) for axis, own in zip("xyz", axes, strict=True)}
    return found


def _peak(
    channel: str, part: str, loads: Mapping[str, Mapping[str, np.ndarray]], cases: Mapping[str, Solution]
) -> Peak:
    highest = {case: int(np.nanargmax(np.abs(each[channel]))) for case, each in loads.items()}
    case = max(highest, key=lambda name: abs(loads[name][channel][highest[name]]))
    at = highest[case]
    return Peak(part, float(loads[case][channel][at]), float(cases[case].time[at]), case)
