"""The records of a study: what all runs share, what differs, how combinations are chosen."""

import re
from typing import Annotated, Any, Literal

import tomli_w
from pydantic import Field, field_validator

from thermobearing.border.schema import OneLine, Strict
from thermobearing.border.toml import to_table
from thermobearing.earthquake.case import EarthquakeCase
from thermobearing.studies.definition.factors import (
    AmbientFactor,
    BearingFactor,
    MotionFactor,
    NumberFactor,
    ScaleFactor,
    StructureFactor,
)

MOST_RUNS = 10_000_000
DesignKind = Literal["factorial", "latin-hypercube", "sobol", "monte-carlo"]
OF_FACTORS = ("structure", "bearings", "motions", "ambient")  # keys of a case that factors hold
Samples = Annotated[int, Field(ge=1, le=MOST_RUNS)]


class Design(Strict):
    """How the combinations are chosen.

    Attributes
    ----------
    kind : of the draws of what has a distribution; levels meet in every combination.
    samples : draws for each combination of levels.
    seed : of the draws.
    paired : every combination of levels has the same draws (default), or draws of its own.
    arrangement : "plain" (default), or "saltelli" for Sobol' indices: two sets of draws A and B,
        and for each drawn factor A with that factor from B.
    lockstep : runs of one shape side by side (docs/theory.md), which differ from runs alone by
        rounding; None for studies of 5000 runs or more, whose histories are not all kept and
        whose numbers of heat are not varied.
    """

    kind: DesignKind = "factorial"
    samples: Samples | None = None
    seed: Annotated[int, Field(ge=0)] = 0
    paired: bool = True
    arrangement: Literal["plain", "saltelli"] = "plain"
    lockstep: bool | None = None

    @classmethod
    def conflicts(cls, given: dict[str, Any]) -> list[str]:
        """What each kind of draw asks for."""
        kind, samples = given.get("kind", "factorial"), given.get("samples")
        faults = []
        if kind != "factorial" and samples is None:
            faults.append(f'missing key "samples": kind = "{kind}" draws that many')
        if kind == "sobol" and isinstance(samples, int) and samples > 0 and samples.bit_count() > 1:
            below = 1 << (samples.bit_length() - 1)
            faults.append(
                f"samples = {samples}: a Sobol sequence takes powers of two, {below} or {2 * below}"
            )
        if kind == "factorial" and given.get("arrangement") == "saltelli":
            faults.append(
                'arrangement = "saltelli": needs draws; take kind = "sobol", "latin-hypercube" or '
                '"monte-carlo"'
            )
        return faults


class Keep(Strict):
    """What is kept besides the table of runs; `histories` of "none", "all" or "worst 10"."""

    histories: str = "none"

    @property
    def worst(self) -> int:
        """Number of the worst runs whose histories are kept."""
        kind, _, count = self.histories.partition(" ")
        return int(count) if kind == "worst" else 0

    @field_validator("histories")
    @classmethod
    def _which(cls, histories: str) -> str:
        if not re.fullmatch(r"none|all|worst [1-9][0-9]{0,5}", histories):
            raise ValueError(f'"{histories}": must be "none", "all", or "worst 10" (any number)')
        return histories


class Factors(Strict):
    """Everything that differs between runs; one level is none that differs.

    `numbers` are those with a dotted name.
    """

    structure: StructureFactor
    bearing: BearingFactor
    motion: MotionFactor
    scale: ScaleFactor = ScaleFactor(levels=[1.0])
    ambient: AmbientFactor
    numbers: dict[str, NumberFactor] = Field(default_factory=dict)


class Study(Strict):
    """A study: its runs are what `plan` makes of it.

    Attributes
    ----------
    kind : "study".
    name : of the study.
    case : what all runs share, with the first level of each factor.
    design : how the combinations are chosen.
    factors : what differs.
    keep : which histories are kept.
    """

    kind: Literal["study"] = "study"
    name: Annotated[str, Field(min_length=1, max_length=100, pattern=r"^[^/\\]*$"), OneLine]
    case: EarthquakeCase
    design: Design = Design()
    factors: Factors
    keep: Keep = Keep()

    def to_toml(self) -> str:
        """The study with names resolved and defaults filled in; reads back to the same runs."""
        table = to_table(self)
        for key in OF_FACTORS:
            table["case"].pop(key, None)
        table["factors"] |= {
            name: to_table(factor) for name, factor in table["factors"].pop("numbers").items()
        }
        return tomli_w.dumps(table)
