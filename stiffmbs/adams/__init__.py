"""Adams/Solver datasets (.adm): text to statements, statements to data, data to a scene."""
