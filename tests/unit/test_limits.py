"""Every number that a file may hold has limits, and says them in words."""

from collections.abc import Iterator
from typing import Annotated, Any, get_args

import pytest
from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel, Field
from pydantic.fields import FieldInfo

import thermobearing as tb
from tests.unit.inputs import SPECIMEN, assert_told, changed_table, specimen_table
from thermobearing.bearing.bilinear import BilinearBearing, list_bilinear, load_bilinear
from thermobearing.bearing.library import bearing_from_table
from thermobearing.bearing.model import Bearing, Validity
from thermobearing.border.schema import Strict, in_unit, validated
from thermobearing.cyclic.case import Case
from thermobearing.design.case import DesignCase
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.structure.model import Structure, list_structures, load_structure

FILES = (Bearing, BilinearBearing, Structure, Case, EarthquakeCase, DesignCase)
USUAL = 10.0  # how far the limits are from what is in the library, at least
# Ratios that end at 1 by their meaning, and s that ends at -1; beside these, temperatures (and
# their coefficients, which are logarithms already) and what is zero for nothing are left out.
MEANT = {"post_yield_ratio", "surface_ratio", "end_spreading", "yield_rotation", "shape"}


def parts(item: Any) -> Iterator[Any]:
    inner = [*item.metadata, item.annotation] if isinstance(item, FieldInfo) else get_args(item)
    yield item
    for part in inner:
        yield from parts(part)


def models_below(model: type[BaseModel], seen: dict[str, type[BaseModel]]) -> None:
    if model.__name__ in seen:
        return
    seen[model.__name__] = model
    for field in model.model_fields.values():
        for part in parts(field):
            if isinstance(part, type) and issubclass(part, BaseModel):
                models_below(part, seen)


MODELS: dict[str, type[BaseModel]] = {}
for file in FILES:
    models_below(file, MODELS)


def limits(model: type[BaseModel], name: str) -> tuple[list[float], list[float]]:
    found = list(parts(model.model_fields[name]))
    low = [part.ge if isinstance(part, Ge) else part.gt for part in found if type(part) in (Ge, Gt)]
    high = [part.le if isinstance(part, Le) else part.lt for part in found
            if type(part) in (Le, Lt)]  # fmt: skip
    return low, high


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_every_number_has_two_limits(model: type[BaseModel]) -> None:
    """A count has at least a lower one, and is at most as large as what it repeats allows."""
    for name, field in model.model_fields.items():
        kinds = {part for part in parts(field) if isinstance(part, type)}
        low, high = limits(model, name)
        if float in kinds:
            assert low, f"{model.__name__}.{name} has no lower limit"
            assert high, f"{model.__name__}.{name} has no upper limit"
            assert low[0] < high[0]
        elif int in kinds:
            assert low, f"{model.__name__}.{name} has no lower limit"


def numbers(model: BaseModel) -> Iterator[tuple[type[BaseModel], str, float]]:
    for name in type(model).model_fields:
        value = getattr(model, name)
        for item in value if isinstance(value, list | tuple) else [value]:
            if isinstance(item, BaseModel):
                yield from numbers(item)
            elif isinstance(item, float):
                yield type(model), name, item


LIBRARY: list[Strict] = [
    *(tb.load_bearing(name) for name in tb.list_bearings()),
    *(load_bilinear(name) for name in list_bilinear()),
    *(load_structure(name) for name in list_structures()),
]


@pytest.mark.parametrize("record", LIBRARY, ids=lambda record: record.name)
def test_limits_are_a_factor_of_ten_from_the_usual(record: Strict) -> None:
    for model, name, value in numbers(record):
        low, high = limits(model, name)
        if value == 0.0 or name in MEANT or name.endswith(("_ratio", "exponent", "scale")):
            continue
        if "temperature" in name or name in ("coldest", "warmest") or model is Validity:
            continue  # what a test reached is no number of a bearing
        size = abs(value)
        assert USUAL * size <= max(abs(high[0]), abs(low[0])), f"{model.__name__}.{name} = {value}"
        if low[0] > 0.0:
            assert size / USUAL >= low[0], f"{model.__name__}.{name} = {value}"


H, G, M = "hysteresis.", "geometry.", "materials."


@pytest.mark.parametrize(
    ("changes", "pieces"),
    [
        ({H + "elastic_temperature_coefficient": 1e6}, ["= 1000000.0", "-20 and at most 5"]),
        ({H + "hysteretic_temperature_coefficient": 5.5}, ["= 5.5", "-20 and at most 5"]),
        ({H + "layer_stiffness": "30 GN/mm"}, ["at least 0.0001 and at most 1e+06 kN/mm"]),
        ({H + "layer_stiffness": "200000 kN/mm"}, ["K_r t_r / A of 1.74e+04 MPa", "10000 MPa"]),
        ({H + "layer_stiffness": "0.001 kN/mm"}, ["K_r t_r / A of 8.68e-05 MPa", "0.001 to"]),
        ({H + "yield_displacement": "1 um"}, ["yield strain of 0.0002", "0.001 to 10"]),
        ({H + "yield_displacement": "60 mm"}, ["yield strain of 12", "0.001 to 10"]),
        ({G + "plan.side": "240 m"}, ["geometry.plan.side", "at least 1 and at most 100000 mm"]),
        ({G + "sealing_plate_thickness": "5e-324 mm"}, ["sealing_plate_thickness", "none or"]),
        ({G + "sealing_plate_thickness": "0.001 mm"}, ["0.001 mm is none or at least 0.05 mm"]),
        ({M + "rubber.density": "1 kg/m^3"}, ["materials.rubber.density", "at least 50"]),
        ({M + "side_film": "1e6 W/(m^2 K)"}, ["materials.side_film", "at most 100000"]),
    ],
    ids=range(12),
)
def test_nonsense_in_a_bearing(changes: dict[str, Any], pieces: list[str]) -> None:
    table = changed_table(specimen_table(), changes)
    with pytest.raises(tb.InputError) as caught:
        bearing_from_table(table, "bearing")
    assert_told(str(caught.value), pieces)


@pytest.mark.parametrize("thickness", ["0 mm", "0.05 mm", "3 cm"])
def test_no_sealing_plate_or_one(thickness: str) -> None:
    table = changed_table(specimen_table(), {G + "sealing_plate_thickness": thickness})
    assert bearing_from_table(table, "bearing").name == SPECIMEN


def test_a_field_without_limits_has_those_of_a_slip() -> None:
    class Free(Strict):
        number: float

    assert validated(Free, {"number": -1e12}, "free").number == -1e12
    with pytest.raises(tb.InputError, match=r"at most 1e\+12 in size; is it a slip"):
        validated(Free, {"number": 1e13}, "free")


class Walk(Strict):
    length: Annotated[float, in_unit("mm"), Field(gt=0)] = 1.0
    share: Annotated[float, Field(ge=0, lt=1)] = 0.0
    steps: Annotated[int, Field(gt=2, le=5)] = 3
    drift: float = 0.0


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"length": 0.0}, "length = 0.0: must be a number greater than 0 mm"),
        ({"share": -0.1}, "share = -0.1: must be a number at least 0 and less than 1"),
        ({"share": 1.0}, "share = 1.0: must be a number at least 0 and less than 1"),
        ({"steps": 2}, "steps = 2: must be a whole number greater than 2 and at most 5"),
        ({"steps": 6}, "steps = 6: must be a whole number greater than 2 and at most 5"),
        ({"length": 1.1e12}, "length = 1100000000000.0: must be at most 1e+12 mm in size"),
        ({"length": 0.9e-12}, "length = 9e-13: must be at least 1e-12 mm in size"),
        ({"drift": -2e12}, "drift = -2000000000000.0: must be at most 1e+12 in size"),
        ({"drift": float("nan")}, "drift = nan: must be a finite number"),
        ({"steps": True}, "steps = True: must be a whole number"),
        ({"lenght": 2.0}, 'unknown key "lenght"; did you mean "length"?'),
    ],
)
def test_what_is_allowed(given: dict[str, Any], said: str) -> None:
    with pytest.raises(tb.InputError) as caught:
        Walk(**given)
    assert said in str(caught.value)


@pytest.mark.parametrize("given", [{"length": 1e12}, {"length": 1e-12}, {"drift": 1e-300}])
def test_sizes_that_are_no_slip(given: dict[str, float]) -> None:
    assert Walk(**given).model_dump() | given == Walk(**given).model_dump()
