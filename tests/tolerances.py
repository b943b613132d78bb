"""Every tolerance of the tests, by name, with the reason for its size.

Rounding is eps = 2.2e-16 relative. A tolerance is relative unless its comment gives a unit.
"""

# --- Convergence -------------------------------------------------------------------------
ORDER = 0.1  # observed order of convergence against theory, in the asymptotic range

# --- Hysteretic variable -----------------------------------------------------------------
SPLIT_INCREMENT = 1e-12  # of d_y: a thousand roundings of about 1e-16 each, with room
BOUND_ROUNDING = 1e-15  # |Z| <= d_y up to a few roundings
TANGENT_STEP = 1e-6  # of d_y: central-difference step where truncation meets rounding
TANGENT_HYSTERESIS = 1e-7  # truncation and rounding at that step are both below 1e-8
SCIPY_RELATIVE = 1e-12  # what DOP853 is asked for
SCIPY_ABSOLUTE = 1e-14  # of d_y
SCIPY_HYSTERESIS = 1e-9  # of d_y: the other solver's own error is about 1e-12

# --- Conduction --------------------------------------------------------------------------
MODE_CAP = 3e-4  # of the mode's peak, 32 + 32 cells; the second mode comes to 2.5e-4
TIME_CAP = 1e-5  # K after 8 s with dt = 20 ms, from cells up to 40 K apart; 7e-6 measured
STEADY_CAP = 3e-4  # of the peak, 32 + 32 cells; 2.5e-4 measured
FIXED_POINT = 1e-12  # of the steady peak: rounding of large fluxes that cancel
ADIABATIC_RISE = 1e-9  # conductivity of 1e-14 W/(m K) leaks less than that
HEAT_BALANCE = 1e-13  # of the heat moved: a few hundred roundings
RECIPROCITY = 1e-14  # two products of the same numbers
NEW_EXTREME = 1e-12  # K, rounding at 60 degC

# --- Published scheme --------------------------------------------------------------------
PUBLISHED_COEFFICIENT = 1e-12  # the same products in SI and in kN, mm, s: some ten roundings
PUBLISHED_STEP = 1e-12  # K, temperatures up to 40 degC through a 19 x 19 solve
