"""
A structure before the analysis
===============================

Parts, periods, damping and mode shapes of the pier of the library, from its TOML file. Copy that
file as a start for your own.

Command: ``thermobearing structures show pier-p1 -o structure``
"""

import thermobearing as tb

looked = tb.examine_structure("pier-p1")
looked.plot.model()

# %%
# The modes of the structure on its bearings.

looked.plot.modes()
