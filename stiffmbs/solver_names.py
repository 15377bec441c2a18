"""Names of solvers, schemes and formulations; schema, messages, help and types are derived from them."""

from __future__ import annotations

from typing import Literal

SolverName = Literal["bdf", "radau", "projected", "kinematic", "auto"]
SchemeName = Literal["euler_cromer", "rk4", "dopri5", "dop853", "linearly_implicit_euler", "extrapolated_euler"]
FormulationName = Literal["SI2", "SI2_exact", "SI1", "I3", "index1"]
CHOICES: dict[str, object] = {"SolverName": SolverName, "SchemeName": SchemeName, "FormulationName": FormulationName}
