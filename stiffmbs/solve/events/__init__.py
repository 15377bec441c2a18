"""Events: breakpoints of inputs, event functions of forces, and ends of runs."""
