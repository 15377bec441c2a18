"""Static equilibria as text."""

from __future__ import annotations

from ..analyses.equilibrium import EquilibriumFound
from ..compile.bodies import BODY_KINDS
from ..describe.model_data import ModelData


def equilibrium_text(found: EquilibriumFound, model: ModelData) -> str:
    """Return a table of the poses of bodies, the force and torque of each element on its first body, and states."""
    kind = BODY_KINDS[model.dimensions]
    head = f"{found.name or 'model'}: equilibrium at t = {found.t:g} s after {found.moves} moves, imbalance {found.imbalance:.1e}"
    tables = (
        ("pose (m, rad)", model.bodies, kind.positions),
        ("force, torque (N, N m)", {**model.joints, **model.forces}, kind.reactions),
    )
    lines = [head]
    for title, names, labels in tables:
        width = max((len(name) for name in names), default=0)
        lines.append(f"{title}: {', '.join(labels)}")
        for name in names:
            values = [found.channels.get(f"{name}.{label}") for label in labels]
            if None not in values:
                lines.append(f"  {name:<{width}}  " + "  ".join(f"{value:>14.8g}" for value in values))
    states = {**model.state_values(), **model.state_outputs()}
    if states:
        width = max(map(len, states))
        lines += ["states:", *(f"  {name:<{width}}  {found.channels[name]:>14.8g}" for name in states)]
    return "\n".join([*lines, *(f"note: {note}" for note in found.notes)])
