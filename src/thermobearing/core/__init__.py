"""The physics: plain numbers in, plain numbers out, compiled from this one source.

Nothing here knows about files, labels or units; everything is in kN, mm, s, degC and
J (1 kN mm = 1 J). Read `step.py` first: it is the one coupled step that every analysis
uses; `hysteresis.py`, `sharing.py` and `heat.py` are its three parts.
"""
