"""Changes of a scene that must not change its motion, and how channels of both runs are compared."""
