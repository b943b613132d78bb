"""
A bridge pier in an earthquake
==============================

The pier of the source's five-span bridge on two kinds of bearings, in a Level 2 motion of the
inland type. Cold bearings move less and pull more at the pier.
"""

import thermobearing as tb

study = tb.bridge(["shen-hdr-bridge", "shen-lhdr-bridge"], "jra-ii-i-1", [23, 0, -20])
study.plot.loops()

# %%
# Shear strain in time, with its peaks.

study.plot.strain()

# %%
# The base of the pier: moment over rotation, with the yield point of the hinge.

study.plot.hinge()
