"""Temperature factors of codes and makers, compared with the factors of a bearing."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from thermobearing.bearing.model import Bearing
from thermobearing.bearing.sources import is_never_tested
from thermobearing.border.lazy import pd
from thermobearing.border.library import read_data
from thermobearing.border.schema import Strict
from thermobearing.core.records import Floats
from thermobearing.results.ranges import NEVER_TESTED

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
        # Warmer than the table its last factor holds; colder, the stiffening is not extrapolated.
        at = np.append(np.asarray(temperatures, dtype=np.float64), reference)
        factors = np.interp(at, self.temperatures, self.factors, left=np.nan)
        return np.asarray(factors[:-1] / factors[-1])


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
    bearings: dict[Literal["calibrated", "never_tested", "unstated"], str]
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
    # 2 (D - D_y) / (pi D^2) is the same at both temperatures and cancels in the factor of h_eq.
    equivalent = share * strength + (1.0 - share) * stiffness
    return {"K_eq": equivalent, "h_eq": strength / equivalent}


def code_factors(
    kind: str, reference: float, temperatures: Floats, share: float
) -> dict[tuple[str, str], dict[str, Floats]]:
    """Return factors by code, class of rubber and quantity, at temperatures [degC]."""
    factors: dict[tuple[str, str], dict[str, Floats]] = {}
    for item in tables_for(kind):
        if item.code:
            values = item.relative_to(reference, temperatures)
            factors.setdefault((item.code, item.rubber), {})[item.quantity] = values
    for by_quantity in factors.values():
        by_quantity |= bilinear_factors(by_quantity["Q_d"], by_quantity["K_d"], share)
    return factors


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
    stated = np.array([values for by_quantity in codes.values() for values in by_quantity.values()])
    place = int(np.argmax(np.isfinite(stated).all(axis=0)))  # 0 where no code reaches
    compared = []
    for quantity in COMPARED:
        row: dict[str, Any] = {"quantity": quantity, "ambient_degC": float(cold[place])}
        quantity_rows = rows[(rows["quantity"] == quantity) & (rows["ambient_degC"] == cold[place])]
        for basis in ("first", "heated"):
            basis_row = quantity_rows[quantity_rows["basis"] == basis].iloc[0]
            row[basis] = float(basis_row["factor"])
            row |= {f"{basis}_{end}": float(basis_row[f"factor_{end}"]) for end in ("low", "high")}
        row["codes"] = {}
        for (code, rubber), by_quantity in codes.items():
            if np.isfinite(by_quantity[quantity][place]):
                row["codes"].setdefault(code, {})[rubber] = float(by_quantity[quantity][place])
        row["difference"] = _difference(row)
        compared.append(row)
    return compared


def compare_with_makers(
    table: "pd.DataFrame", strain: float, kind: str, reference: float
) -> list[dict[str, Any]]:
    """Compare the factors of a bearing with those of makers: a row for each of their tables.

    At the coldest temperature that the makers state. A bearing with lead has the makers' factors of
    lead rubber bearings too: its rubber is another one then, and `kinds` of the row say so.
    """
    kinds = {kind, "LRB"} if kind == "LHDR" else {kind}
    makers = [item for item in published().tables if not item.code and kinds & set(item.kinds)]
    rows = table[(table["strain"] == strain) & (table["ambient_degC"] < reference)]
    cold = np.sort(rows["ambient_degC"].unique())
    compared = []
    for item in makers:
        values = item.relative_to(reference, cold)
        for place in np.flatnonzero(np.isfinite(values))[:1]:
            same = (rows["quantity"] == item.quantity) & (rows["ambient_degC"] == cold[place])
            factors = rows[same].set_index("basis")["factor"]
            row: dict[str, Any] = {
                "quantity": item.quantity,
                "name": item.name,
                "kinds": item.kinds,
            }
            row |= {"ambient_degC": float(cold[place]), "factor": float(values[place])}
            compared.append(row | {basis: float(factors[basis]) for basis in ("first", "heated")})
    # Those of the same kind of bearing first.
    return sorted(compared, key=lambda row: kind not in row["kinds"])


def _difference(row: dict[str, Any]) -> str:
    """Return how far the first cycle is from the factors of the codes."""
    values = [value for rubbers in row["codes"].values() for value in rubbers.values()]
    if not values:
        return "none stated"
    factor, low, high = row["first"], min(values), max(values)
    if low <= factor <= high:
        return "within"
    end, side = (high, "above") if factor > high else (low, "below")
    difference = f"{100.0 * abs(factor / end - 1.0):.0f} % {side}"
    if not np.isfinite([row["first_low"], row["first_high"]]).all():
        return difference
    overlaps = row["first_low"] <= high and row["first_high"] >= low
    return f"{difference}, {'interval overlaps' if overlaps else 'no overlap'}"


def _basis(bearing: Bearing) -> Literal["calibrated", "never_tested", "unstated"]:
    """Return what is known of the tests behind the parameters of a bearing."""
    if bearing.tested_range is not None:
        return "calibrated"
    return "never_tested" if is_never_tested(bearing.sources) else "unstated"


def reasons(bearing: Bearing, rows: list[dict[str, Any]], share: float) -> list[str]:
    """Return why the factors of a bearing differ from those of codes, as sentences without stop."""
    texts, basis = published(), _basis(bearing)
    bearing_words = texts.bearings[basis].format(never_tested=NEVER_TESTED)
    sentences = [text.format(bearing=bearing_words) for text in texts.reasons]
    rows_by_quantity = {row["quantity"]: row for row in rows}
    code_values = {
        quantity: [value for rubbers in row["codes"].values() for value in rubbers.values()]
        for quantity, row in rows_by_quantity.items()
    }
    if not any(code_values.values()):
        return sentences
    strength, stiffness = (rows_by_quantity[quantity]["first"] for quantity in MADE_OF)
    pairs_of_codes = zip(*(code_values[quantity] for quantity in MADE_OF), strict=True)
    strength_leads_in_codes = all(q > k for q, k in pairs_of_codes)
    # h_eq is proportional to Q_d over K_eq: which of the two factors is larger decides whether
    # damping increases or decreases in the cold.
    if strength_leads_in_codes and not strength > stiffness:
        sentences.append(
            "In the cold, K_d of this bearing increases more than Q_d, so that h_eq decreases; in "
            "the codes Q_d increases more, so that h_eq increases"
        )
    sentences.append(
        f"At this strain, Q_d is {100.0 * share:.0f} % of the peak force of a bilinear loop with "
        "Q_d and K_d"
    )
    return sentences
