"""What is done with a model: prepared, checked, run, compiled ahead."""
