"""
A bearing judged by a test it has not seen
==========================================

Nothing is fitted: the bearing, as it is, is moved as the test was. Here the lead bearing is judged
by a test of the bearing without lead, and by one of its own.
"""

import thermobearing as tb

test = tb.cyclic_test(strain=[1.0, 1.75], cycles=3, wave="sine", rest=None)
names = ["shen-lhdr-specimen", "shen-hdr-specimen"]
records = [tb.synthetic_record(name, 0, test, seed=3) for name in names]
found = tb.validate_bearing("shen-lhdr-specimen", records)
found.plot.loops()

# %%
# Model over test, cycle by cycle.

found.plot.ratios()
