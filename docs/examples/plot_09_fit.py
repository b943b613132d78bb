"""
A fit to tests at two temperatures
==================================

Parameters of a bearing from cyclic tests, with standard errors. The tests are made up here, from
the model with noise, so that the true values are known; yours come from
`tb.load_test("test.csv")`.
"""

import thermobearing as tb

test = tb.cyclic_test(strain=[0.5, 1.0, 1.75], cycles=3, rest=None)
records = [tb.synthetic_record("shen-hdr-specimen", t, test, seed=1) for t in (-20, 23)]
free = ["alpha_0", "K_r", "d_y", "b", "m_T", "n_T"]
fit = tb.identify_bearing(records, "shen-hdr-specimen", free=free, starts=1)
fit.show()

# %%
# Loops of test and model, with the residuals of the force.

fit.plot.loops()

# %%
# What depends on what: correlation of the parameters.

fit.plot.correlation()
