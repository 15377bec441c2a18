"""Trees of links on hinges in space, as users of other tools would write them: a file for each tool.

It has ``contestants(tree)``.
"""
