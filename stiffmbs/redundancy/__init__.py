"""Structure of a mechanism before its solution: loops, rank, redundancy, unique reactions, remedies."""
