"""Studies: many runs of one scene with other values, and their evaluation."""
