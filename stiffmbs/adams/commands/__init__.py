"""Command files of MSC Adams/Solver: simulations, and the changes before each."""
