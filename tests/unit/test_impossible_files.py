"""Files that no laboratory can have measured: none is believed by identify, validate or measure.

Each is made from one record of the model with noise, with one mistake. It is an error or a warning
of the check that knows the mistake, in all three; the record without a mistake has neither.
"""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import thermobearing as tb
from tests.quick import quick_cases
from thermobearing.border.errors import InputError
from thermobearing.identify.fit.synthetic import synthetic_record
from thermobearing.identify.records.checks import check_test
from thermobearing.identify.records.measured import measure_cycles
from thermobearing.identify.records.record import load_test
from thermobearing.validate.run import _refuse_unusable

BEARING = tb.load_bearing("shen-hdr-specimen")
T, X, F, INSIDE = "time_s", "displacement_mm", "force_kN", "rubber 1 [degC]"


@pytest.fixture(scope="module")
def good() -> pd.DataFrame:
    test = tb.cyclic_test(strain=[0.5, 1.5], cycles=3, rest=None)
    record = synthetic_record(BEARING, 23.0, test, noise=0.005)
    inside = 23.0 + 3.0 * np.linspace(0.0, 1.0, len(record.time))
    columns = (record.time, record.displacement, record.force, inside)
    return pd.DataFrame(dict(zip((T, X, F, INSIDE), columns, strict=True)))


def noise(rows: pd.DataFrame, size: float) -> np.ndarray:
    return size * np.random.default_rng(1).normal(size=len(rows))


def clipped(rows: pd.DataFrame, jitter: float = 0.0) -> pd.DataFrame:
    top = 0.7 * rows[F].abs().max()
    return rows.assign(**{F: rows[F].clip(-top, top) + noise(rows, jitter * top)})


def joined(rows: pd.DataFrame, *, restart: bool) -> pd.DataFrame:
    """The first 55 % of a test, and the last 60 % as if they followed."""
    first, second = rows[: int(0.55 * len(rows))], rows[int(0.4 * len(rows)) :]
    begin = 0.0 if restart else float(first[T].iloc[-1]) + 0.01
    return pd.concat([first, second.assign(**{T: second[T] - second[T].iloc[0] + begin})])


def stuck(rows: pd.DataFrame) -> pd.DataFrame:
    time, middle = rows[T].to_numpy(copy=True), len(rows) // 2
    time[middle : middle + 200] = time[middle]
    return rows.assign(**{T: time})


def with_words(rows: pd.DataFrame) -> pd.DataFrame:
    rows = rows.astype({F: object})
    rows.iloc[100:110, 2] = "NaN"
    return rows


# The change, and a check that names the mistake ("" for one of several).
IMPOSSIBLE: dict[str, tuple[Callable[[pd.DataFrame], pd.DataFrame], str]] = {
    "rows shuffled": (lambda r: r.sample(frac=1.0, random_state=1), ""),
    "time backwards": (lambda r: r.assign(**{T: r[T].to_numpy()[::-1]}), ""),
    "played backwards": (
        lambda r: r.assign(**{X: r[X].to_numpy()[::-1], F: r[F].to_numpy()[::-1]}), "columns"
    ),
    "stamps that stick": (stuck, "time"),
    "displacement in m": (lambda r: r.assign(**{X: r[X] / 1e3}), "unit"),
    "displacement in cm": (lambda r: r.assign(**{X: r[X] / 10.0}), "unit"),
    "force in N": (lambda r: r.assign(**{F: r[F] * 1e3}), "unit"),
    "force in tonf": (lambda r: r.assign(**{F: r[F] / 9.80665}), "unit"),
    "force reversed": (lambda r: r.assign(**{F: -r[F]}), "assumed"),
    "force constant": (lambda r: r.assign(**{F: 12.0}), "force"),
    "force constant with noise": (lambda r: r.assign(**{F: 12.0 + noise(r, 0.1)}), ""),
    "displacement constant": (lambda r: r.assign(**{X: 3.0}), "displacement"),
    "displacement constant with noise": (lambda r: r.assign(**{X: 3.0 + noise(r, 0.01)}), "rows"),
    "kelvin": (lambda r: r.assign(**{INSIDE: r[INSIDE] + 273.15}), "thermocouple"),
    "fahrenheit": (lambda r: r.assign(**{INSIDE: 1.8 * r[INSIDE] + 32.0}), "thermocouple"),
    "milliseconds": (lambda r: r.assign(**{T: r[T] * 1e3}), "speed"),
    "minutes": (lambda r: r.assign(**{T: r[T] / 60.0}), "speed"),
    "first half twice": (lambda r: pd.concat([r[: len(r) // 2], r]), "rows"),
    "each row twice": (lambda r: r.loc[r.index.repeat(2)], "time"),
    "force clipped": (clipped, "saturation"),
    "force clipped with noise": (lambda r: clipped(r, 0.002), "saturation"),
    "joined with a jump": (lambda r: joined(r, restart=False), "rows"),
    "joined with a clock that restarts": (lambda r: joined(r, restart=True), "blocks"),
    "NaN in words": (with_words, ""),
    "force of noise": (lambda r: r.assign(**{F: noise(r, 20.0)}), ""),
    "force of another test": (
        lambda r: r.assign(**{F: 50.0 * np.sin(2.0 * np.pi * r[T] / 7.3)}), "energy"
    ),
    "force computed": (lambda r: r.assign(**{F: 2.0 * r[X]}), "energy"),
    "columns swapped": (lambda r: r.assign(**{X: r[F], F: r[X]}), "columns"),
}  # fmt: skip


def written(rows: pd.DataFrame, folder: Path) -> Path:
    path = folder / "t.csv"
    rows.to_csv(path, index=False)
    path.with_suffix(".toml").write_text('ambient = "23 degC"\n')
    return path


def judged(path: Path) -> Iterator[list[str]]:
    """Yield the sentences of identify, validate and measure about a file: errors or warnings."""
    for read in (
        lambda: [f.sentence for f in check_test(path, BEARING).findings if f.level != "note"],
        lambda: _refuse_unusable([load_test(path)], BEARING),
        lambda: measure_cycles(path, BEARING).notes,
    ):
        try:
            yield read()
        except InputError as error:
            yield error.problems


@pytest.mark.parametrize("name", quick_cases(list(IMPOSSIBLE), 0, 1, 8, 13, 16, 17, 20, 22, 26))
def test_no_impossible_file_is_believed(good: pd.DataFrame, name: str, tmp_path: Path) -> None:
    change, check = IMPOSSIBLE[name]
    path = written(change(good), tmp_path)
    assert all(judged(path)), name
    if check:
        levels = {f.check: f.level for f in check_test(path, BEARING).findings if f.level != "note"}
        assert check in levels


def test_the_file_without_a_mistake_is_believed(good: pd.DataFrame, tmp_path: Path) -> None:
    """`measure` names the closing cycles of the two amplitudes, the fourth and the eighth."""
    *warnings, (note,) = judged(written(good, tmp_path))
    assert warnings == [[], []]
    assert note.startswith("closing cycles")
    assert ": 4 and 8;" in note


@pytest.mark.parametrize("bearing", ["shen-hdr-specimen", "shen-lhdr-specimen", "lrb-example"])
@pytest.mark.parametrize("ambient", quick_cases([-20.0, 23.0], 1))
def test_records_of_the_model_with_noise_have_no_warning(bearing: str, ambient: float) -> None:
    """Also of lead, whose force hardly rises, and of growing and repeated cycles."""
    for changes in ({"noise": 0.0}, {"noise": 0.02}, {"noise": 0.01, "first_cycle": 1.3}):
        test = tb.cyclic_test(strain=[0.5, 1.5], cycles=3, rest=None, wave="sine")
        report = check_test(synthetic_record(bearing, ambient, test, **changes), bearing)
        assert report.outcome == "good", report.findings
