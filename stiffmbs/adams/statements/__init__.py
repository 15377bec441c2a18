"""The statements of a dataset of Adams/Solver: read, and checked one by one."""
