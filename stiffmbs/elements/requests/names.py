"""Names available in requests, in the plane and in space.

In addition to the measures of other formulas (`stiffmbs.reading.formula.names`), requests can use accelerations,
angles, components of joints and forces, and every channel.
"""

from __future__ import annotations

from dataclasses import dataclass

from ...reading.formula.names import PLANE, SPACE, FormulaNames

OF_RUN = {"energy": ("kinetic", "potential", "total"), "constraint": ("position", "velocity")}
"""Channels of the whole model."""


@dataclass(frozen=True)
class OutputNames:
    """Names of one family of models."""

    measures: tuple[str, ...]  # measures between two markers, as in Adams
    along_axes: tuple[str, ...]  # measures that accept a third marker, along whose axes they are resolved
    # force and torque of a joint or force on its first body, or on its second (``hinge.j``), along ground axes or those
    # of a marker: ``fx(hinge)``, ``tz(hinge.j, bar.end)``; fm and tm are magnitudes
    actions: tuple[str, ...]
    # of_bodies, of_elements: channels of a body, and of a joint or force: ``bar.ax``, ``hinge.fx``
    of_bodies: tuple[str, ...]
    of_elements: tuple[str, ...]


def _names(
    of_formulas: FormulaNames, measures: str, along: str, actions: str, accelerations: str, of_elements: str
) -> OutputNames:
    every = (*of_formulas.position_measures, *of_formulas.velocity_measures, *measures.split())
    return OutputNames(
        measures=tuple(dict.fromkeys(every)),
        along_axes=(*of_formulas.along_axes, *along.split()),
        actions=tuple(actions.split()),
        of_bodies=(*of_formulas.positions, *of_formulas.velocities, *accelerations.split()),
        of_elements=tuple(of_elements.split()),
    )


OF_PLANE = _names(PLANE, "accx accy accm wdtz", "accx accy", "fx fy fm tz", "ax ay alpha", "fx fy torque")
OF_SPACE = _names(
    SPACE,
    "accx accy accz accm wdtx wdty wdtz wdtm psi theta phi q0 q1 q2 q3",
    "accx accy accz wdtx wdty wdtz",
    "fx fy fz fm tx ty tz tm",
    "ax ay az wdx wdy wdz",
    "fx fy fz tx ty tz",
)
"""psi, theta and phi are body-fixed rotations about z, x and z."""
