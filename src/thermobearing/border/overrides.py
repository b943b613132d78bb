"""Values given in Python or on the command line, put over those of a file."""

from collections.abc import Mapping
from typing import Any

from thermobearing.border.errors import InputError
from thermobearing.border.schema import Strict, unit_of
from thermobearing.border.units import with_unit


def said_with_unit(value: Any, unit: str | None) -> Any:
    """Plain numbers, alone or in a sequence, as text with their unit, as a file has them."""
    if unit is None:
        return value
    if hasattr(value, "tolist"):  # numpy arrays and scalars
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [said_with_unit(item, unit) for item in value]
    if isinstance(value, int | float) and not isinstance(value, bool):
        return with_unit(value, unit)
    return value


def updated(table: Any, changes: Mapping[str, Any]) -> Any:
    """The table with changes; what is no table stays as it is, for the checks to find."""
    return {**table, **changes} if isinstance(table, dict) else table


def overridden(
    table: Mapping[str, Any],
    given: Mapping[str, Any],
    model: type[Strict],
    sections: Mapping[str, type[Strict]] | None = None,
) -> dict[str, Any]:
    """A table of a file with what was given instead.

    Parameters
    ----------
    table : as read from a file, where every number says its unit.
    given : values by key of the model or of one of its sections; plain numbers are in the unit
        of the key, and None leaves the value of the table. An unknown key goes into the table
        too, for the check to find it.
    model : what the table is to become.
    sections : tables inside the table whose keys may be given directly, such as "analysis".

    Examples
    --------
    >>> from thermobearing.border.schema import in_unit
    >>> from typing import Annotated
    >>> class Walk(Strict):
    ...     length: Annotated[float, in_unit("mm")]
    ...     name: str = ""
    >>> overridden({"length": "5 m"}, {"length": 70, "name": None}, Walk)
    {'length': '70.0 mm'}
    """
    table = dict(table)
    for key, value in given.items():
        if value is None:
            continue
        homes = [] if key in model.model_fields else list((sections or {}).items())
        home = next((item for item in homes if key in item[1].model_fields), None)
        owner = home[1] if home else model
        unit = unit_of(owner, key) if key in owner.model_fields else None
        said = said_with_unit(value, unit)
        if home:
            table[home[0]] = updated(table.get(home[0], {}), {key: said})
        else:
            table[key] = said
    return table


def check_workers(where: str, executor: Any = None, progress: Any = None) -> None:
    """Refuse an executor or a callback that cannot be one, before anything is computed.

    Raises
    ------
    InputError : an executor without `submit`, or a callback that cannot be called.

    Examples
    --------
    >>> check_workers("example", None, print)
    """
    if executor is not None and not callable(getattr(executor, "submit", None)):
        raise InputError("executor: must be one of concurrent.futures, or like it", where)
    if progress is not None and not callable(progress):
        raise InputError("progress: must be a function of two numbers", where)
