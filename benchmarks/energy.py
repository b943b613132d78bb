"""Do the energy books close, over the whole of Table 3.4 with its rests?"""

import thermobearing as tb
from benchmarks.rows import Row, at_most, plain
from benchmarks.specimen import AMBIENTS, NAME

LIMIT = 1e-10  # of the work done


def rows() -> list[Row]:
    """Both books at each temperature; the published scheme is only said, not judged."""
    found = []
    books = tb.run(NAME, tb.cyclic_test(), ambient=AMBIENTS).energy
    for _, book in books.iterrows():
        where = f"at {book['ambient_degC']:g} degC"
        mechanical, thermal = book["mechanical_residual"], book["thermal_residual"]
        found.append(at_most(f"work - heat - recoverable, {where}", abs(mechanical), LIMIT))
        found.append(at_most(f"heat released - stored - lost, {where}", abs(thermal), LIMIT))
    books = tb.run(NAME, tb.cyclic_test(), ambient=AMBIENTS, scheme="published").energy
    for _, book in books.iterrows():
        what = f"heat released - stored - lost, published scheme, {book['ambient_degC']:g} degC"
        found.append(plain(what, 100.0 * float(book["thermal_residual"]), "%", "of the work done"))
    return found
