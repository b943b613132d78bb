"""Temperature factors of codes and makers, compared with the factors of a bearing."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from thermobearing.border.lazy import pd
from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict
from thermobearing.core.records import Floats

FOOTNOTE = "*: chosen, or not checked against the published text"
COMPARED = ("K_eq", "Q_d", "K_d", "h_eq")
MADE_OF = ("Q_d", "K_d")  # the factors that codes state


class PublishedTable(Strict):
    """Factors from elsewhere, of bearings of some kinds; of a code, a class of rubber."""

    name: str
    kinds: Annotated[list[Literal["HDR", "LHDR", "LRB"]], Field(min_length=1)]
    code: str = ""
    rubber: str = ""
    quantity: str
    reference_temperature: float
    temperatures: Annotated[list[float], Field(min_length=2)]
    factors: Annotated[list[float], Field(min_length=2)]
    source: str
    unverified: bool

    def relative_to(self, reference: float, temperatures: Floats) -> Floats:
        """Return factors over that at a reference temperature; NaN colder than the table."""
        at = np.append(np.asarray(temperatures, dtype=np.float64), reference)
        found = np.interp(at, self.temperatures, self.factors, left=np.nan)
        return np.asarray(found[:-1] / found[-1])


class _PublishedCode(Strict):
    """What a code requires about temperature; `unverified`: its text was not read."""

    name: str
    code: str
    clause: str
    says: str
    origin: str
    source: str
    same_as: str = ""
    unverified: bool


class Published(Strict):
    """Content of data/factors/published.toml."""

    codes: list[_PublishedCode]
    reasons: list[str]
    tables: list[PublishedTable]


def published() -> Published:
    """Return factors of other sources and codes, with citation and whether it was verified."""
    return read_data(Published, "factors", "published.toml")


def tables_for(kind: str) -> list[PublishedTable]:
    """Return the published factors for bearings of a kind: "HDR", "LHDR" or "LRB"."""
    return [item for item in published().tables if kind in item.kinds]


def strength_share(
    table: "pd.DataFrame", strain: float, reference: float, displacement: float
) -> float:
    """Return the share of Q_d in the peak force Q_d + K_d D of the first cycle."""
    same = (table["strain"] == strain) & (table["ambient_degC"] == reference)
    value = table[same & (table["basis"] == "first")].set_index("quantity")["value"]
    strength = float(value["Q_d"])
    return strength / (strength + float(value["K_d"]) * displacement)


def bilinear_factors(strength: Floats, stiffness: Floats, share: float) -> dict[str, Floats]:
    """Return factors of K_eq and h_eq of a bilinear loop from those of Q_d and K_d.

    K_eq = Q_d/D + K_d and h_eq = 2 Q_d (D - D_y) / (pi K_eq D^2) with the same displacement D and
    yield displacement D_y; `share` is that of Q_d in Q_d + K_d D at the reference temperature.
    """
    equivalent = share * strength + (1.0 - share) * stiffness
    return {"K_eq": equivalent, "h_eq": strength / equivalent}


def code_factors(
    kind: str, reference: float, temperatures: Floats, share: float
) -> dict[tuple[str, str], dict[str, Floats]]:
    """Return factors by code, class of rubber and quantity, at temperatures [degC]."""
    found: dict[tuple[str, str], dict[str, Floats]] = {}
    for item in tables_for(kind):
        if item.code:
            values = item.relative_to(reference, temperatures)
            found.setdefault((item.code, item.rubber), {})[item.quantity] = values
    for one in found.values():
        one |= bilinear_factors(one["Q_d"], one["K_d"], share)
    return found


def compare_with_codes(
    table: "pd.DataFrame", strain: float, kind: str, reference: float, share: float
) -> list[dict[str, Any]]:
    """Compare the factors of a bearing with those of codes: a row for each quantity.

    At the coldest temperature for which the codes have factors, otherwise at the coldest.
    """
    rows = table[table["strain"] == strain]
    cold = np.sort(rows.loc[rows["ambient_degC"] < reference, "ambient_degC"].unique())
    if not len(cold):
        return []
    codes = code_factors(kind, reference, cold, share)
    stated = np.array([values for one in codes.values() for values in one.values()])
    place = int(np.argmax(np.isfinite(stated).all(axis=0)))  # 0 where no code reaches
    found = []
    for quantity in COMPARED:
        row: dict[str, Any] = {"quantity": quantity, "ambient_degC": float(cold[place])}
        same = rows[(rows["quantity"] == quantity) & (rows["ambient_degC"] == cold[place])]
        for basis in ("first", "heated"):
            mine = same[same["basis"] == basis].iloc[0]
            row[basis] = float(mine["factor"])
            row |= {f"{basis}_{end}": float(mine[f"factor_{end}"]) for end in ("low", "high")}
        row["codes"] = {}
        for (code, rubber), one in codes.items():
            if np.isfinite(one[quantity][place]):
                row["codes"].setdefault(code, {})[rubber] = float(one[quantity][place])
        row["difference"] = _difference(row)
        found.append(row)
    return found


def _difference(row: dict[str, Any]) -> str:
    """Return how far the first cycle is from the factors of the codes."""
    values = [value for rubbers in row["codes"].values() for value in rubbers.values()]
    if not values:
        return "none stated"
    mine, low, high = row["first"], min(values), max(values)
    if low <= mine <= high:
        return "within"
    end, side = (high, "above") if mine > high else (low, "below")
    found = f"{100.0 * abs(mine / end - 1.0):.0f} % {side}"
    if np.isfinite([row["first_low"], row["first_high"]]).all():
        reaches = row["first_low"] <= high and row["first_high"] >= low
        found += ", interval overlaps" if reaches else ", no overlap"
    return found


def reasons(rows: list[dict[str, Any]], share: float) -> list[str]:
    """Return why the factors of a bearing differ from those of codes, as sentences without stop."""
    found = list(published().reasons)
    by = {row["quantity"]: row for row in rows}
    theirs = {
        name: [v for one in row["codes"].values() for v in one.values()] for name, row in by.items()
    }
    if not any(theirs.values()):
        return found
    mine = [by[name]["first"] for name in MADE_OF]
    more = [
        mine[0] > mine[1],
        all(q > k for q, k in zip(*(theirs[n] for n in MADE_OF), strict=True)),
    ]
    if more == [False, True]:
        found.append(
            "In the cold, K_d of this bearing increases more than its Q_d, in the codes "
            "less: h_eq decreases here, and increases in the codes"
        )
    found.append(
        f"At this strain, Q_d is {100.0 * share:.0f} % of the peak force of a bilinear loop with "
        "Q_d and K_d"
    )
    return found
