"""Events: breakpoints of inputs, event functions of forces, and where a run ends."""
