"""Forward sensitivities: how outputs of a run change with parameters."""
