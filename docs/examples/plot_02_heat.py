"""
Where the heat goes
===================

Five fast cycles of the bearing with lead in the cold, followed by a rest of a quarter of an hour.
Rubber and lead warm up during the cycles; afterwards the heat flows through the steel to the end
plates.

Command: ``thermobearing cyclic --bearing shen-lhdr-specimen --strain 1.75 --strain 1 --wave sine
--frequency 0.5 --rest 900 --ambient -20 -o heat``
"""

import thermobearing as tb

test = tb.cyclic_test(strain=[1.75, 1.0], wave="sine", frequency=0.5, rest=900.0)
result = tb.run("shen-lhdr-specimen", test, ambient=-20, keep=["rubber", "cells"])
result.plot.layer_temperatures()

# %%
# The lead dissipates much energy in a small volume: it is far hotter than the rubber, and cools
# first.

result.plot.lead_temperature()

# %%
# The temperature through the height at the end of each loading.

result.plot.profiles()
