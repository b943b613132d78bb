"""The cold town of docs/cold_town.md: its two studies, tables and figures.

`python -m benchmarks.cold_town` carries out the studies (6600 runs; minutes) and prints the tables
of the page; `python -m docs.generate` draws its figures too.
"""

import tempfile
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from thermobearing.climate.generator import generate_weather
from thermobearing.climate.hourly import Hourly
from thermobearing.earthquake.run import bearing_weather
from thermobearing.results import drawing
from thermobearing.studies.definition.case import load_study
from thermobearing.studies.run.engine import run_study
from thermobearing.studies.statistics.demand import counted
from thermobearing.studies.statistics.fragility import (
    Fragility,
    combine_curves,
    fragility_curves,
)
from thermobearing.studies.statistics.hazard import (
    Hazard,
    Rate,
    annual_rate,
    ratio,
    shares_of_time,
)
from thermobearing.studies.store import Store

STUDIES = {"hours": "cold-town", "levels": "cold-town-levels"}
INTENSITY, WARM, COLD = "Sa_m_s2", 23.0, -20.0
BEARINGS = {
    "shen-bilinear-bridge": "bilinear design",
    "shen-hdr-bridge": "HDR",
    "shen-lhdr-bridge": "LHDR",
}
LAYERED = list(BEARINGS)[1:]
# An example as the climate is: 8 m/s2 at 1.2 s once in a thousand years.
SITE = Hazard([1.0, 25.0], [0.18, 0.18 * 25.0**-2.5], "Sa")


class Limit(NamedTuple):
    """A limit: the demand and the capacity. Failed runs count as in every study."""

    label: str
    demand: str
    capacity: float

    def rows(self, table: pd.DataFrame, bearing: str) -> pd.DataFrame:
        """Runs of a bearing."""
        return table[table["bearing"] == bearing].reset_index(drop=True)


LIMITS = (
    Limit("pier yields", "pier_ductility", 1.0),
    Limit("bearing beyond 250 %", "bearing_strain_max", 2.5),
)


class Answer(NamedTuple):
    """Of one bearing and limit: curves by temperature, and over the climate."""

    curves: dict[float, Fragility]
    climate: Fragility
    shares: np.ndarray  # of the time, of each temperature

    def rates(self) -> dict[str, Rate]:
        """How often a year, by what the temperature is taken to be."""
        parts = {
            "23 degC": self.curves[WARM],
            "climate": self.climate,
            "-20 degC": self.curves[COLD],
        }
        return {name: annual_rate(part, SITE) for name, part in parts.items()}


def tables(folder: Path) -> dict[str, pd.DataFrame]:
    """Runs of both studies; those that are missing are done."""
    runs = {}
    for name, study in STUDIES.items():
        run_study(load_study(study), folder / name)
        runs[name] = Store(folder / name).table()
    return runs


def answers(runs: dict[str, pd.DataFrame], warmth: dict[str, Any]) -> dict[tuple[str, str], Answer]:
    """By bearing and limit."""
    by_bearing = {}
    for bearing in BEARINGS:
        for limit in LIMITS:
            wanted = (limit.demand, limit.capacity, INTENSITY)
            curves = fragility_curves(
                limit.rows(runs["levels"], bearing),
                *wanted,
                "ambient_degC",
                method="ida",
            )
            shares = shares_of_time(list(curves), warmth[bearing])
            by_bearing[bearing, limit.label] = Answer(
                curves, combine_curves(curves, shares), shares
            )
    return by_bearing


def rates_table(results: dict[tuple[str, str], Answer]) -> list[str]:
    """How often a year, and how much ignoring the temperature misses."""
    rows = [
        "| once in ... years | 23 degC throughout | over the climate | -20 degC throughout | "
        "climate over 23 degC |",
        "|---|---|---|---|---|",
    ]
    for limit in LIMITS:
        for bearing, label in BEARINGS.items():
            answer = results[bearing, limit.label]
            rates = answer.rates()
            cells = [_years(rates[name]) for name in ("23 degC", "climate", "-20 degC")]
            times = ratio(rates["climate"], rates["23 degC"])
            high = f"to {times[2]:.2f}" if np.isfinite(times[2]) else "or more"
            times_text = f"{times[0]:.2f} ({times[1]:.2f} {high})"
            rows.append(f"| {limit.label}, {label} | {' | '.join(cells)} | {times_text} |")
    return rows


def _years(rate: Rate) -> str:
    """Return period with its band; a bound where no motion went beyond."""
    if not rate.rate > 0.0:
        return f"more than {1.0 / rate.high:.0f} (none of {rate.groups} motions)"
    last = f" to {1.0 / rate.low:.0f}" if rate.low > 0.0 else " or more"
    return f"{rate.return_period:.0f} ({1.0 / rate.high:.0f}{last})"


def parts_table(results: dict[tuple[str, str], Answer]) -> list[str]:
    """What each temperature adds to the rate at which the pier yields."""
    parts = {}
    for name in LAYERED:
        curves, _, share = results[name, LIMITS[0].label]
        rates = np.array([annual_rate(curve, SITE).rate for curve in curves.values()])
        added = np.where(share > 0.0, share * rates, 0.0)
        parts[name] = {"share": share, "part": added / added.sum()}
    shares_text = {"share": "share of the time", "part": "share of the times that the pier yields"}
    columns = [(key, name) for key in shares_text for name in LAYERED]
    heads = " | ".join(f"{shares_text[key]}, {BEARINGS[name]}" for key, name in columns)
    rows = [f"| temperature of the rubber | {heads} |", "|---" * (1 + len(columns)) + "|"]
    for k, degrees in enumerate(results[LAYERED[0], LIMITS[0].label].curves):
        shares = " | ".join(f"{100 * parts[name][key][k]:.1f} %" for key, name in columns)
        rows.append(f"| {degrees:g} degC | {shares} |")
    return rows


def shares_beyond(table: pd.DataFrame, bearing: str, limit: Limit) -> pd.Series:
    """Share of the runs that go beyond, at each intensity."""
    demands = counted(limit.rows(table, bearing), limit.demand, capacity=limit.capacity)
    beyond = pd.Series(demands.demand > limit.capacity)
    return beyond.groupby(demands.table[INTENSITY].to_numpy()).mean()


def hours_table(runs: dict[str, pd.DataFrame], warmth: dict[str, Any]) -> list[str]:
    """Compare runs at hours of the weather with levels weighted by their share of the time.

    Only at the intensities that both studies have.
    """
    in_both = runs["levels"][INTENSITY].isin(runs["hours"][INTENSITY].unique())
    levels = runs["levels"][in_both].groupby("ambient_degC")
    rows = [
        "| share of the runs, intensities of both | hours of the weather | levels by their share "
        "of the time | deviation by chance |",
        "|---|---|---|---|",
    ]
    for limit in LIMITS:
        for bearing, label in BEARINGS.items():
            drawn = shares_beyond(runs["hours"], bearing, limit)
            level_shares = [shares_beyond(part, bearing, limit).mean() for _, part in levels]
            shares = shares_of_time(list(levels.groups), warmth[bearing])
            count = (runs["hours"]["bearing"] == bearing).sum() / len(drawn)
            chance = np.sqrt((drawn * (1.0 - drawn)).sum() / count) / len(drawn)
            rows.append(
                f"| {limit.label}, {label} | {100 * drawn.mean():.1f} % | "
                f"{100 * float(np.dot(shares, level_shares)):.1f} % | {100 * chance:.1f} % |"
            )
    return rows


def failed_line(runs: dict[str, pd.DataFrame]) -> str:
    """What became of the runs that failed."""
    sentences = []
    for name, table in runs.items():
        counts = table["outcome"].value_counts().drop("completed", errors="ignore")
        outcomes = ", ".join(f"{count} {outcome}" for outcome, count in counts.items()) or "none"
        sentences.append(
            f"{STUDIES[name]}: {counts.sum()} of {len(table)} runs failed ({outcomes})"
        )
    return "; ".join(sentences)


def draw_weather(weather: Hourly, warmth: pd.DataFrame) -> Figure:
    """A cold fortnight, and fifty years of air and rubber."""
    figure, (left, right) = drawing.panels(1, 2, (7.1, 3.0), "weather of a cold town")
    middle = int(np.argmin(weather.temperature))
    part = warmth.iloc[middle - 168 : middle + 168]
    days = np.arange(len(part)) / 24.0
    lines = (
        ("air", "ambient_degC", drawing.GREY, 0.9),
        ("inner rubber layer", "inner_rubber_degC", "#CC3311", 2.0),
        ("outer rubber layer", "outer_rubber_degC", "#0077BB", 0.8),
    )
    for label, column, colour, width in lines:
        left.plot(days, part[column], color=colour, linewidth=width, label=label)
    drawing.name_axes(left, "days", "temperature [degC]")
    left.legend(frameon=False, fontsize=drawing.SMALL, loc="lower right")
    edges = np.arange(-40.0, 41.0, 2.0)
    for column, label, colour in (
        ("ambient_degC", "air", drawing.GREY),
        ("rubber_degC", "rubber", "#CC3311"),
    ):
        share, _ = np.histogram(warmth[column], edges)
        right.step(edges[:-1], 100.0 * share / len(warmth), where="post", color=colour, label=label)
    drawing.name_axes(right, "temperature [degC]", "share of the time in 2 K [%]")
    right.legend(frameon=False, fontsize=drawing.SMALL)
    return figure


def draw_fragility(results: dict[tuple[str, str], Answer], runs: dict[str, pd.DataFrame]) -> Figure:
    """Fragility of both layered bearings: pier above, bearing below."""
    figure, axes = drawing.panels(2, 2, (7.1, 5.6), "fragility at each temperature")
    at = np.linspace(2.0, 22.0, 200)
    for ax, (limit, bearing) in zip(
        axes, [(limit, name) for limit in LIMITS for name in LAYERED], strict=True
    ):
        answer = results[bearing, limit.label]
        temperatures = list(answer.curves)
        for temperature in temperatures:
            colour = drawing.COLD_TO_WARM((temperature + 30.0) / 60.0)
            curve = answer.curves[temperature]
            if curve.estimate.known:
                label = f"{temperature:g} degC"
                ax.plot(at, curve.probability(at), color=colour, linewidth=1.2, label=label)
        ax.plot(at, answer.climate.probability(at), "k-", linewidth=2.0, label="over the climate")
        shares = shares_beyond(runs["hours"], bearing, limit)
        ax.plot(shares.index, shares, "ko", ms=3.5, label="runs at hours of the weather")
        ax.set_title(f"{limit.label}, {BEARINGS[bearing]}", fontsize=drawing.NORMAL, loc="left")
        drawing.name_axes(ax, "Sa(1.2 s) [m/s2]", "probability")
    drawing.legend_below(figure, axes[0].get_lines())
    return figure


def draw_rates(results: dict[tuple[str, str], Answer]) -> Figure:
    """Annual rates by what the temperature is taken to be."""
    figure, axes = drawing.panels(1, 2, (7.1, 3.1), "how often a year")
    cold, warm = drawing.ambient_colours(np.array([COLD, WARM]))
    looks = (
        ("23 degC", warm, "23 degC throughout"),
        ("climate", drawing.INK, "over the climate"),
        ("-20 degC", cold, "-20 degC throughout"),
    )
    for ax, limit in zip(axes, LIMITS, strict=True):
        for k, (name, colour, label) in enumerate(looks):
            rates = [results[bearing, limit.label].rates()[name] for bearing in BEARINGS]
            x = np.arange(len(rates)) + 0.26 * (k - 1)
            values = 1e3 * np.array([rate.rate for rate in rates])
            low, high = (
                1e3 * np.array([getattr(r, end) for r in rates]) for end in ("low", "high")
            )
            ax.bar(x, values, 0.24, color=colour, label=label)
            ends = np.maximum([values - low, high - values], 0.0)
            ax.errorbar(x, values, ends, fmt="none", ecolor=drawing.GREY, elinewidth=0.8)
        ax.set_xticks(range(len(BEARINGS)), list(BEARINGS.values()), fontsize=drawing.SMALL)
        ax.set_title(limit.label, fontsize=drawing.NORMAL, loc="left")
        drawing.name_axes(ax, "", "times in a thousand years")
    axes[0].legend(frameon=False, fontsize=drawing.SMALL, loc="upper left")
    return figure


@cache
def carry_out() -> tuple[str, dict[str, Figure]]:
    """Carry out both studies (minutes); return the tables of the page and its figures."""
    with tempfile.TemporaryDirectory() as folder:
        runs = tables(Path(folder))
    weather = generate_weather("cold-town", years=50, seed=1)
    frames = {name: bearing_weather(name, weather) for name in LAYERED}
    warmth = {name: frame["rubber_degC"] for name, frame in frames.items()}
    warmth[next(iter(BEARINGS))] = weather.temperature
    results = answers(runs, warmth)
    parts = (rates_table(results), parts_table(results), hours_table(runs, warmth))
    text = "\n\n".join(["\n".join(part) for part in parts] + [failed_line(runs)])
    return text, {
        "cold_town_weather": draw_weather(weather, frames[LAYERED[1]]),
        "cold_town_fragility": draw_fragility(results, runs),
        "cold_town_rates": draw_rates(results),
    }


def draw() -> dict[str, Figure]:
    """Return the figures of the page."""
    return carry_out()[1]


if __name__ == "__main__":
    print(carry_out()[0])
