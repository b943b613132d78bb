"""
A hybrid test in real time and at low speed
===========================================

A specimen is tested in a loop with a computed pier. In the pseudo-dynamic test it moves slowly,
so that the rubber loses its heat and its rate dependence is lost.

Command: ``thermobearing hybrid --bearing shen-lhdr-specimen --ambient -20 --duration 12 --mode rt
--mode pd -o hybrid``
"""

import thermobearing as tb

laboratory = {"mode": ["rt", "pd"]}
study = tb.hybrid("shen-lhdr-specimen", ambient=[-20], duration=12, laboratory=laboratory)
study.plot.modes()

# %%
# The speed of the actuator in each test, over the time in the laboratory.

study.plot.speed()
