"""Bodies in space that bushings and struts hold, without joints, as users of other tools would write them: a file for each tool.

It has ``contestants(given)``.
"""
