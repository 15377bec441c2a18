"""What equations and motions mean: redundancy and degrees of freedom, reactions, energies, requests."""
