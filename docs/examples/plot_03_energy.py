"""
The energy balance of a run
===========================

The work of the actuator becomes heat or is stored. Heat is still in the bearing, or has left it
through the ends and sides. The title shows the residual of the balance, which is at rounding.

Command: ``thermobearing cyclic --bearing shen-hdr-specimen --strain 2 --ambient -20 --model-option
heat_source=dissipation -o energy``
"""

import thermobearing as tb

test = tb.cyclic_test(strain=[2.0], cycles=5, rest=None)
result = tb.run(
    "shen-hdr-specimen", test, ambient=-20, model=tb.ModelOptions(heat_source="dissipation")
)
result.plot.energy()

# %%
# The shares of rubber, lead cores and rate-dependent branch in the force of a bearing with lead.

tb.run("shen-lhdr-specimen", test, ambient=-20).plot.force_shares()
