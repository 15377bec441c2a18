"""Translation of Adams/Solver function expressions to formulas of a scene."""
