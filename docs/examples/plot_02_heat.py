"""
Where the heat goes
===================

Five quick cycles of the lead bearing in the cold, and a quarter of an hour of rest. Rubber and
lead warm up while they work; afterwards the heat flows through the steel to the end plates.
"""

import thermobearing as tb

test = tb.cyclic_test(strain=[1.75, 1.0], wave="sine", frequency=0.5, rest=900.0)
result = tb.run("shen-lhdr-specimen", test, ambient=-20, keep=["rubber", "cells"])
result.plot.layer_temperatures()

# %%
# The lead is small and works hard: it is far hotter than the rubber, and cools first.

result.plot.lead_temperature()

# %%
# Temperature through the height at the ends of the loadings.

result.plot.profiles()
