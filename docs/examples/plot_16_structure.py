"""
A structure before it is shaken
===============================

Parts, periods, damping and mode shapes of the pier of the library, from its TOML file. Copy that
file for your own.
"""

import thermobearing as tb

looked = tb.examine_structure("pier-p1")
looked.plot.model()

# %%
# Its modes on the bearings.

looked.plot.modes()
