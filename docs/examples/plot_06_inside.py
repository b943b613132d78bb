"""
Inside a bearing during an earthquake
=====================================

Temperatures of rubber and lead of the bridge bearings while the ground shakes, from two ambient
temperatures.
"""

import thermobearing as tb

study = tb.bridge("shen-lhdr-bridge", "jra-ii-i-1", [23, -20], keep=["rubber", "cells"])
study.plot.temperature()

# %%
# Through the height: middle of the shaking, and its end.

study.plot.profiles()
