"""
Comparison with earlier models
==============================

Ten cycles in the cold by models that neglect the temperature, its distribution, or the heat flow.

Command: ``thermobearing cyclic --bearing shen-hdr-specimen --strain 1.75 --cycles 10 --wave sine
--frequency 0.5 --ambient -20 --compare -o models``
"""

import thermobearing as tb

test = tb.cyclic_test(strain=[1.75], cycles=10, wave="sine", frequency=0.5, rest=None)
models = ["multi-layer", "single-temperature", "adiabatic", "temperature-blind"]
results = {name: tb.run("shen-hdr-specimen", test, ambient=-20, model=name) for name in models}
tb.overlay(results, title="ten cycles at -20 degC")

# %%
# The modulus of the tenth cycle over that of the first shows how much each model softens.

for name, result in results.items():
    modulus = result.to_dataset().G_eq_MPa.sel(ambient=-20, strain=1.75)
    print(f"{name:20} {float(modulus.sel(cycle=10) / modulus.sel(cycle=1)):.2f}")
