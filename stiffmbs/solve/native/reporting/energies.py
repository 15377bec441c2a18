"""Energies and power at output times."""

from __future__ import annotations

from stiffmbs.compile.machine.native.access import shifted


def energies(
    count, n_u, u, mass, n_values, values, n_potential, potential_at, n_power, power_at, kinetic, potential, power
):
    """Compute kinetic and potential energy and power in `count` rows of velocities and output terms."""
    for row in range(count):
        velocity = shifted(u, row * n_u)
        term = shifted(values, row * n_values)
        total = 0.0
        for k in range(n_u):
            total += mass[k] * velocity[k] * velocity[k]
        kinetic[row] = 0.5 * total
        total = 0.0
        for k in range(n_potential):
            total += term[potential_at[k]]
        potential[row] = total
        total = 0.0
        for k in range(n_power):
            total += term[power_at[k]]
        power[row] = total
