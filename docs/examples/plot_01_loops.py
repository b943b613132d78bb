"""
A cyclic test at three temperatures
===================================

Table 3.4 of the source on its high damping rubber specimen: five amplitudes of five cycles, with
rests between. The colder, the stiffer.
"""

import thermobearing as tb

result = tb.run("shen-hdr-specimen", ambient=[-20, 0, 23])
result.plot.loops()

# %%
# Modulus and damping of each cycle: within five cycles the rubber warms up and softens.

result.plot.measures()
