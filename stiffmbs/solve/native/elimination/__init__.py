"""J M^-1 J^T formed and factored: by dense blocks of joints, or entry by entry."""
