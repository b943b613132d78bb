"""Columns of a study in words, for axes and tables."""

UNITS = {
    "_kN_mm": "kN mm",
    "_kN_m": "kN m",
    "_m_s2": "m/s²",
    "_m_s": "m/s",
    "_mm": "mm",
    "_kN": "kN",
    "_degC": "°C",
    "_rad": "rad",
}
ABBREVIATED = {"max": "largest", "degC": "°C"}


def words_of(column: str) -> str:
    """A column without its unit, as words.

    Examples
    --------
    >>> words_of("pier_displacement_max_mm"), words_of("bearing.K_r"), words_of("PGA_m_s2")
    ('largest pier displacement', 'bearing.K_r', 'PGA')
    """
    if "." in column:
        return column
    name = column
    for ending in UNITS:
        if name.endswith(ending):
            name = name.removesuffix(ending)
            break
    words = name.split("_")
    if words[-1] == "max" and len(words) > 1:
        words = ["largest", *words[:-1]]
    return " ".join(words)


def unit_of(column: str) -> str:
    """The unit in the name of a column; "" without one.

    Examples
    --------
    >>> unit_of("pier_displacement_max_mm"), unit_of("scale")
    ('mm', '')
    """
    return next((unit for ending, unit in UNITS.items() if column.endswith(ending)), "")


def title_of(column: str) -> str:
    """Words with the unit in brackets.

    Examples
    --------
    >>> title_of("ambient_degC")
    'ambient [°C]'
    """
    unit = unit_of(column)
    return f"{words_of(column)} [{unit}]" if unit else words_of(column)
