"""Description of spatial mechanisms; files have the names of their planar counterparts."""
