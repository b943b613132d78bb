"""
Energy books
============

Every run keeps books: what the actuator puts in is heat, or still stored. Heat is in the bearing,
or has left through its ends and sides. The residual stands in the title; it is rounding.
"""

import thermobearing as tb

test = tb.cyclic_test(strain=[2.0], cycles=5, rest=None)
result = tb.run("shen-hdr-specimen", test, ambient=-20, heat_source="dissipation")
result.plot.energy()

# %%
# Who carries the force of a bearing with lead: rubber, lead cores, rate branch.

tb.run("shen-lhdr-specimen", test, ambient=-20).plot.force_shares()
