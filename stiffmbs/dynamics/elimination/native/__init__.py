"""Assembly and factorisation of J M^-1 J^T, by dense blocks of joints or by pins."""
