"""
A cyclic test at three temperatures
===================================

The test programme of Shen (2023), Table 3.4, on a specimen of high-damping rubber: five amplitudes
with five cycles each and rests between them. The bearing is stiffer at lower temperatures.

Command: ``thermobearing cyclic --bearing shen-hdr-specimen --ambient -20 --ambient 0 --ambient 23
-o test``
"""

import thermobearing as tb

result = tb.run("shen-hdr-specimen", ambient=[-20, 0, 23])
result.plot.loops()

# %%
# Modulus and damping of each cycle: within five cycles the rubber warms up and softens.

result.plot.measures()

# %%
# .. only:: live
#
#    The page below computes the same test in the browser (:doc:`how to write such a page
#    </guide/live_page>`). Move the temperature.
#
#    .. raw:: html
#
#       <iframe class="live" loading="lazy"
#        src="../_static/bearing.html#base=shen-hdr-specimen&protocol=table-3.4&wave=triangle"
#        title="A bearing that is tested in this page at the temperature that you choose">
#       </iframe>
