"""
Temperatures inside a bearing during an earthquake
==================================================

Temperatures of rubber and lead in the bridge bearings during the shaking, from two ambient
temperatures.

Command: ``thermobearing bridge --bearing shen-lhdr-bridge --motion jra-ii-i-1 --ambient 23
--ambient -20 -o inside``
"""

import thermobearing as tb

study = tb.bridge("shen-lhdr-bridge", "jra-ii-i-1", [23, -20], keep=["rubber", "cells"])
study.plot.temperature()

# %%
# The temperature through the height in the middle and at the end of the shaking.

study.plot.profiles()
