"""
A bridge pier in an earthquake
==============================

The pier of the five-span bridge of Shen (2023) on two kinds of bearings, in a Level 2 motion of
Type II. Cold bearings shear less and transmit larger forces to the pier.

Command: ``thermobearing bridge --bearing shen-hdr-bridge --bearing shen-lhdr-bridge --motion
jra-ii-i-1 --ambient 23 --ambient 0 --ambient -20 -o pier``
"""

import thermobearing as tb

study = tb.bridge(["shen-hdr-bridge", "shen-lhdr-bridge"], "jra-ii-i-1", [23, 0, -20])
study.plot.loops()

# %%
# The history of the shear strain, with its peaks.

study.plot.strain()

# %%
# The moment at the base of the pier over the rotation, with the yield point of the hinge.

study.plot.hinge()

# %%
# .. only:: live
#
#    The page below shakes the same pier in the browser (:doc:`how to write such a page
#    </guide/live_page>`). Move the temperature, or choose another bearing or motion.
#
#    .. raw:: html
#
#       <iframe class="live" loading="lazy"
#        src="../_static/bearing.html#view=bridge&base=shen-lhdr-bridge&motion=jra-ii-i-1"
#        title="A bridge pier that is shaken in this page at the temperature that you choose">
#       </iframe>
