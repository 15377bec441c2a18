"""Load cases of suspensions: kinematics and compliance on a test rig, and road loads of bushings."""
