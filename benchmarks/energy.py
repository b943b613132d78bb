"""Is energy balanced over the whole of Table 3.4 with its rests?"""

import thermobearing as tb
from benchmarks.rows import Row, at_most, plain
from benchmarks.specimen import AMBIENTS, NAME

LIMIT = 1e-10  # of the work done


def rows() -> list[Row]:
    """Both balances at each temperature; of the published scheme the residual is stated only."""
    measured = []
    balances = tb.run(NAME, tb.cyclic_test(), ambient=AMBIENTS).energy
    for _, balance in balances.iterrows():
        place = f"at {balance['ambient_degC']:g} degC"
        mechanical, thermal = balance["mechanical_residual"], balance["thermal_residual"]
        measured.append(at_most(f"work - heat - recoverable, {place}", abs(mechanical), LIMIT))
        measured.append(at_most(f"heat released - stored - lost, {place}", abs(thermal), LIMIT))
    balances = tb.run(
        NAME, tb.cyclic_test(), ambient=AMBIENTS, model=tb.ModelOptions(scheme="published")
    ).energy
    for _, balance in balances.iterrows():
        label = f"heat released - stored - lost, published scheme, {balance['ambient_degC']:g} degC"
        measured.append(
            plain(label, 100.0 * float(balance["thermal_residual"]), "%", "of the work done")
        )
    return measured
