"""Adams/Solver command files: simulations, and the dataset changes before each."""
