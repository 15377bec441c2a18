"""User-defined states: solutions of differential or algebraic equations in addition to the motion."""
