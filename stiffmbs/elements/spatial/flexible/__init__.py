"""Bodies, inertia and interfaces of flexible bodies."""
