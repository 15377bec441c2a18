"""Load cases of suspensions: kinematics and compliance on a test rig, and the loads of bushings in driving."""
