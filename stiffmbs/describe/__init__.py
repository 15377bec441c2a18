"""Description of a mechanism: bodies, markers, joints, forces and scenes. Contains no numerical methods."""
