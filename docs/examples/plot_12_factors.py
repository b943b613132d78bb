"""
Temperature factors
===================

A bounding analysis multiplies stiffness and strength by factors: those of the first cycle in the
cold, and of the third cycle, which has heated the bearing, relative to 23 °C.

Command: ``thermobearing lambda shen-hdr-bridge --strain 1.75 --reference-temperature 23 -o
factors``
"""

from matplotlib.figure import Figure

import thermobearing as tb

temperatures = [-40, -30, -20, -10, 0, 10, 20, 30, 40]
table = tb.temperature_factors(
    "shen-hdr-bridge", reference_temperature=23, temperatures=temperatures, strains=[1.75]
)
figure = Figure(figsize=(5.5, 3.6), layout="constrained")
axes = figure.add_subplot(xlabel="ambient temperature [degC]", ylabel="factor")
for quantity, colour in (("Q_d", "#0077BB"), ("K_d", "#EE7733")):
    for basis, style in (("first", "-"), ("heated", "--")):
        rows = table[(table.quantity == quantity) & (table.basis == basis)]
        axes.plot(rows.ambient_degC, rows.factor, style, color=colour, label=f"{quantity}, {basis}")
axes.legend(frameon=False)
figure

# %%
# .. only:: live
#
#    The page below computes such factors in the browser, at a strain of 100 %, and compares them
#    with published ones (:doc:`how to write such a page </guide/live_page>`). Move the temperature.
#
#    .. raw:: html
#
#       <iframe class="live" loading="lazy"
#        src="../_static/bearing.html#view=codes&base=shen-hdr-bridge"
#        title="Temperature factors of a bearing, computed in this page, and published ones">
#       </iframe>
