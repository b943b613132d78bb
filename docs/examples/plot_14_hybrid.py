"""
A hybrid test, in real time and slowly
======================================

A specimen in the loop with a calculated pier. In the pseudo-dynamic test the actuator is slow: the
rubber has time to lose its heat, and its rate dependence is gone.
"""

import thermobearing as tb

laboratory = {"mode": ["rt", "pd"]}
study = tb.hybrid("shen-lhdr-specimen", ambient=[-20], duration=12, laboratory=laboratory)
study.plot.modes()

# %%
# The speed of the actuator, each in the time of the laboratory.

study.plot.speed()
