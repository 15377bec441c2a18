"""Elements as users write them, outside of the package: one joint and one force in the plane, and the same in space."""
