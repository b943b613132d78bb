"""Columns of a study in words, for axes and tables."""

from thermobearing.report.generic import words

NAMES = {"ambient_degC": "ambient temperature", "hour": "hour of the weather"}


def words_of(column: str) -> str:
    """A column without its unit, as words.

    Examples
    --------
    >>> words_of("pier_displacement_max_mm"), words_of("bearing.K_r"), words_of("PGA_m_s2")
    ('largest pier displacement', 'bearing.K_r', 'PGA')
    """
    if ", " in column:  # several that are drawn together
        return ", ".join(map(words_of, column.split(", ")))
    if "." in column:
        return column
    name = NAMES.get(column) or words(column)[0]
    return f"largest {name.removesuffix(' max')}" if name.endswith(" max") else name


def unit_of(column: str) -> str:
    """The unit in the name of a column; "" without one.

    Examples
    --------
    >>> unit_of("PGV_m_s"), unit_of("pier_rotation_max_rad"), unit_of("scale")
    ('m/s', 'rad', '')
    """
    return "" if "." in column else words(column)[1]


def title_of(column: str) -> str:
    """Words with the unit in brackets.

    Examples
    --------
    >>> title_of("ambient_degC")
    'ambient temperature [°C]'
    """
    unit = unit_of(column)
    return f"{words_of(column)} [{unit}]" if unit else words_of(column)
