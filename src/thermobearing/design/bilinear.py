"""Upper- and lower-bound bilinear models, ready to type into a global analysis."""

from dataclasses import dataclass

import pandas as pd

from thermobearing.border.errors import InputError, printable
from thermobearing.cyclic.equivalent import backbone
from thermobearing.model.earlier import BilinearParameters

UNITS = "kN, mm, s"
BOUNDS_NOTE = (
    "Each bound has the peak force and the loop area of its cycle, with a chosen K_2/K_1; its Q_d "
    "is therefore not that of the factors, which is half the difference of the forces at zero "
    "displacement"
)


@dataclass(frozen=True)
class BoundModel:
    """One bound.

    Attributes
    ----------
    name : "lower" or "upper".
    strain, basis, temperature : where in the table of factors it comes from [degC].
    parameters : Q_d [kN], K_1, K_2 [kN/mm] of one bearing.
    """

    name: str
    strain: float
    basis: str
    temperature: float
    parameters: BilinearParameters

    @property
    def yield_force(self) -> float:
        """Q_d K_1/(K_1 - K_2) [kN]."""
        p = self.parameters
        return p.strength * p.initial / (p.initial - p.post_yield)


def bound_models(
    table: pd.DataFrame, strain: float, total_rubber_thickness: float, kind: str = "LRB"
) -> list[BoundModel]:
    """The softest and the stiffest cycle of a table of factors as bilinear models.

    Softest and stiffest by K_eq over all temperatures and over first and heated cycles; peak
    force and loop area are those of that cycle.

    Parameters
    ----------
    table : of `temperature_factors`.
    strain : one of its strains.
    total_rubber_thickness : of the bearing [mm], > 0.
    kind : of the bearing, "HDR", "LHDR" or "LRB": its K_2/K_1 (data/equivalent).

    Returns
    -------
    list of BoundModel : the lower one, the upper one.

    Raises
    ------
    InputError : the table has no such strain.

    Examples
    --------
    >>> rows = [("first", -20.0, 3.0, 9e4), ("first", 23.0, 2.0, 6e4)]
    >>> table = pd.DataFrame(
    ...     [
    ...         {"strain": 1.0, "basis": b, "ambient_degC": t, "quantity": name, "value": value}
    ...         for b, t, k, e in rows
    ...         for name, value in (("K_eq", k), ("energy", e))
    ...     ]
    ... )
    >>> [(model.name, model.temperature) for model in bound_models(table, 1.0, 100.0)]
    [('lower', 23.0), ('upper', -20.0)]
    """
    rows = table[(table["strain"] == strain) & table["basis"].isin(["first", "heated"])]
    if rows.empty:
        known = ", ".join(f"{value:g}" for value in sorted(set(table["strain"])))
        raise InputError(f"strain = {strain:g}: the table has {known}")
    wide = rows.pivot_table(index=["basis", "ambient_degC"], columns="quantity", values="value")
    ordered = wide.reset_index().sort_values("K_eq").to_dict("records")
    found = []
    for name, row in (("lower", ordered[0]), ("upper", ordered[-1])):
        amplitude = strain * total_rubber_thickness
        model = backbone(float(row["K_eq"]), float(row["energy"]), amplitude, kind)
        temperature = float(row["ambient_degC"])
        found.append(BoundModel(name, strain, str(row["basis"]), temperature, model))
    return found


def bounds_table(models: list[BoundModel]) -> pd.DataFrame:
    """Numbers of the bounds, one row each.

    Parameters
    ----------
    models : from `bound_models`.

    Returns
    -------
    DataFrame : bound, strain, basis, temperature [degC], Q_d and Q_y [kN], K_1 and K_2 [kN/mm].

    Examples
    --------
    >>> from thermobearing.model.earlier import BilinearParameters
    >>> bilinear = BilinearParameters(strength=100.0, initial=10.0, post_yield=2.0)
    >>> model = BoundModel("lower", 1.75, "first", 23.0, bilinear)
    >>> float(bounds_table([model])["Q_y_kN"].iloc[0])
    125.0
    """
    return pd.DataFrame(
        [
            {
                "bound": m.name,
                "strain": m.strain,
                "basis": m.basis,
                "ambient_degC": m.temperature,
                "Q_d_kN": m.parameters.strength,
                "K_1_kN_mm": m.parameters.initial,
                "K_2_kN_mm": m.parameters.post_yield,
                "Q_y_kN": m.yield_force,
            }
            for m in models
        ]
    )


def opensees_text(models: list[BoundModel], name: str, language: str) -> str:
    """Materials for a zeroLength element of OpenSees, in Tcl or Python.

    Parameters
    ----------
    models : from `bound_models`.
    name : of the bearing, for the comment.
    language : "tcl" or "python".

    Returns
    -------
    str : lines of the script.

    Examples
    --------
    >>> from thermobearing.model.earlier import BilinearParameters
    >>> bilinear = BilinearParameters(strength=100.0, initial=10.0, post_yield=2.0)
    >>> model = BoundModel("lower", 1.75, "first", 23.0, bilinear)
    >>> opensees_text([model], "example", "tcl").splitlines()[-1]
    'uniaxialMaterial Steel01 1 125.0 10.0 0.2'
    """
    shown = " ".join(printable(name).split("\n"))  # a second line would be carried out
    lines = [
        f"# {shown}: bilinear bounds of ONE bearing, units {UNITS}.",
        "# Use one of the materials in a zeroLength element, direction 1, per bearing.",
        f"# {BOUNDS_NOTE}.",
    ]
    if language == "python":
        lines.append("import openseespy.opensees as ops")
    for tag, m in enumerate(models, 1):
        p = m.parameters
        lines.append(
            f"# {m.name} bound: {m.basis} cycle at {m.temperature:g} degC, {m.strain:.0%} strain; "
            f"Q_d {p.strength:.6g} kN, K_1 {p.initial:.6g}, K_2 {p.post_yield:.6g} kN/mm"
        )
        values = (m.yield_force, p.initial, p.post_yield / p.initial)
        if language == "python":
            numbers = ", ".join(f"{value!r}" for value in values)
            lines.append(f'ops.uniaxialMaterial("Steel01", {tag}, {numbers})')
        else:
            numbers = " ".join(f"{value!r}" for value in values)
            lines.append(f"uniaxialMaterial Steel01 {tag} {numbers}")
    return "\n".join(lines) + "\n"
