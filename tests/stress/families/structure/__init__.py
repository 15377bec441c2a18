"""Structure: redundancy, assembly, poses, loops, random mechanisms."""
