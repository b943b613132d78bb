"""
Validation with a test that was not used
========================================

Nothing is calibrated: the bearing is moved as in the tests, and the forces are compared. Here the
bearing with lead is compared with a test of its own, and with one of the bearing without lead.

Command: ``thermobearing validate shen-lhdr-specimen TEST.csv -o validation``
"""

import thermobearing as tb

test = tb.cyclic_test(strain=[1.0, 1.75], cycles=3, wave="sine", rest=None)
names = ["shen-lhdr-specimen", "shen-hdr-specimen"]
records = [tb.synthetic_record(name, 0, test, seed=3) for name in names]
found = tb.validate_bearing("shen-lhdr-specimen", records)
found.plot.loops()

# %%
# The ratio of model to test in each cycle.

found.plot.ratios()
