"""
Calibration with tests at two temperatures
==========================================

The parameters of a bearing are determined from cyclic tests, with standard errors. These tests are
synthetic (the model with noise), so that the true values are known; read yours with
`tb.load_test("test.csv")`.

Command: ``thermobearing identify TEST.csv TEST.csv --bearing shen-hdr-specimen -o fit``
"""

import thermobearing as tb

test = tb.cyclic_test(strain=[0.5, 1.0, 1.75], cycles=3, rest=None)
records = [tb.synthetic_record("shen-hdr-specimen", t, test, seed=1) for t in (-20, 23)]
free = ["alpha_0", "K_r", "d_y", "b", "m_T", "n_T"]
fit = tb.identify_bearing(records, "shen-hdr-specimen", free=free, starts=1)
fit.show()

# %%
# Loops of the tests and of the model, with the residuals of the force.

fit.plot.loops()

# %%
# The correlation of the parameters.

fit.plot.correlation()
