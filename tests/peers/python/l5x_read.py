"""Loads a program of Logix (`.L5X`) by the package l5x, with the value of each tag.

    l5x_read.py FILE

The answer is the number of its tags. An error is that of the package.
"""

import sys

import l5x

project = l5x.Project(sys.argv[1])
(program,) = project.programs.names
tags = project.programs[program].tags
values = [tags[name].value for name in tags.names]
print(len(values))
