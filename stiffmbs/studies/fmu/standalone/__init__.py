"""FMUs without Python: one shared library with the machine code and the data of a scene."""
