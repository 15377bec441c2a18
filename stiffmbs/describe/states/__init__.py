"""States of the user's own: values that differential equations or algebraic equations determine beside the motion."""
