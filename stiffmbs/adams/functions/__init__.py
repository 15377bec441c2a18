"""Function expressions of Adams/Solver, translated to formulas of a scene."""
