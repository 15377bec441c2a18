"""Forward sensitivities: derivatives of outputs of a run by parameters."""
