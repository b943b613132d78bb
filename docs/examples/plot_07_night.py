"""
An earthquake after a cold night
================================

Bearings follow the air slowly: after a night that ends at -20 °C the middle of a large bearing is
still warmer than the air. The weather of a day and a night comes first, with the same heat model,
and the earthquake at its end.

Command: ``thermobearing bridge --bearing lrb-example --motion jra-ii-i-1 --weather TEST.csv -o
night``
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import thermobearing as tb

hours = np.arange(0.0, 26.5, 0.5)  # the earthquake comes at 2 o'clock at night
air = -12.0 + 8.0 * np.cos(2.0 * np.pi * (hours - 14.0) / 24.0)
rows = [f"{3600.0 * hour:g},{degrees:.2f}" for hour, degrees in zip(hours, air, strict=True)]
with TemporaryDirectory() as folder:
    weather = Path(folder, "night.csv")
    weather.write_text("\n".join(["time_s,temperature_degC", *rows]))
    study = tb.bridge("lrb-example", "jra-ii-i-1", ambient=weather, keep=["rubber", "cells"])
study.plot.profiles(times=[0.0, 10.0])

# %%
# The air is at -20 °C when the earthquake begins; the rubber is warmer.

study.show()
