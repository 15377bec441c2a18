"""What is known of a mechanism before it is solved: loops, rank of their equations, redundancy, unique reactions, remedies."""
