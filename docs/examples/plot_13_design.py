"""
Sizing bearings
===============

Assume a displacement, size the bearing, analyse the bridge, compare, and repeat (Shen (2023),
Fig. 6.4). Layered bearings of the same stiffness are then checked on the coldest day.

Command: ``thermobearing design -o design``
"""

import thermobearing as tb
from thermobearing.design.case import make_design_case

case = make_design_case({"motions": ["jra-ii-i-1"]}, "example")
templates = [tb.load_bearing("shen-hdr-bridge")]
design = tb.run_design(case, templates=templates)
design.plot.rounds()

# %%
# The layered bearing of that stiffness compared with the bilinear one.

design.plot.equal()
