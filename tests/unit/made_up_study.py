"""Studies whose demands are formulas, for tests of what is made of the runs."""

from functools import cache
from typing import Any

import numpy as np

from thermobearing.studies.definition.case import make_study
from thermobearing.studies.definition.designs import Plan
from thermobearing.studies.question import Question, SiteHazard
from thermobearing.studies.result import StudyResult

MOTIONS = [f"jra-ii-{ground}-{number}" for ground in ("i", "ii") for number in (1, 2, 3)]
INTENSITY = np.geomspace(0.5, 60.0, 8)
HAZARD = SiteHazard(
    intensity=[f"{x} m/s2" for x in INTENSITY], rate=(0.05 * INTENSITY**-2.2).tolist()
)
FACTORS = {
    "bearing": ["shen-hdr-bridge", "shen-lhdr-bridge"],
    "motion": MOTIONS,
    "scale": [0.25, 0.5, 0.75, 1.0, 1.5, 2.0],
    "ambient": ["-20 degC", "0 degC", "23 degC"],
}


SPREAD = {"distribution": "lognormal", "median": 1.0, "cov": 0.2}


@cache
def made_up() -> StudyResult:
    """Ductility by a formula: more in the cold, twice as much more with the first bearing."""
    study = make_study({"kind": "study", "name": "p1", "factors": FACTORS}, "test")
    runs = Plan(study).runs
    rng = np.random.default_rng(1)
    of_motion = dict(zip(MOTIONS, np.exp(rng.normal(0.0, 0.35, len(MOTIONS))), strict=True))
    cold = np.where(runs["bearing"] == "shen-hdr-bridge", 0.012, 0.006)
    demand = runs["PGA_m_s2"] / 8.0 * np.exp(cold * (23.0 - runs["ambient_degC"]))
    demand = demand * runs["motion"].astype(str).map(of_motion)
    outcome = np.where(demand > 3.2, "not_converged", "completed")
    runs = runs.assign(
        outcome=outcome,
        sentence=np.where(demand > 3.2, "try a smaller step", ""),
        beyond_tested="",
        pier_ductility=demand.where(demand <= 3.2),
    )
    return StudyResult(runs, study, {"runs": len(runs)}, "out/p1")


def ask(result: StudyResult, temperatures: Any = None, **options: Any) -> StudyResult:
    """The same runs with other post-processing options."""
    question = Question(**options)
    question._temperatures = temperatures
    return StudyResult(result.table, result.study, result.manifest, result.directory, question)


def beyond_limit() -> StudyResult:
    """Study whose failed runs are those of a pier beyond its limits, which count as collapse."""
    result = made_up()
    outcome = result.table["outcome"].replace("not_converged", "pier_beyond_limit")
    table = result.table.assign(outcome=outcome)
    return StudyResult(table, result.study, result.manifest, "out/p1")


@cache
def drawn(**design: Any) -> StudyResult:
    """Three motions at three intensities, stiffness, strain and temperature drawn for each run."""
    factors = {
        "bearing": "shen-hdr-bridge",
        "motion": MOTIONS[:3],
        "scale": {"of": "intensity", "levels": ["4 m/s^2", "8 m/s^2", "12 m/s^2"]},
        "ambient": {"climate": "cold-town", "years": 1},
        "bearing.K_r": SPREAD,
        "bearing.m_T": SPREAD,
    }
    design = {"kind": "monte-carlo", "samples": 32} | design
    table = {"kind": "study", "name": "drawn", "factors": factors, "design": design}
    study = make_study(table, "test")
    runs = Plan(study).runs
    cold = np.exp(0.012 * (23.0 - runs["ambient_degC"])) * runs["bearing.K_r"]
    noise = np.exp(np.random.default_rng(4).normal(0.0, 0.3, len(runs)))
    demand = runs["PGA_m_s2"] / 8.0 * cold * noise
    runs = runs.assign(outcome="completed", sentence="", beyond_tested="", pier_ductility=demand)
    return StudyResult(runs, study, {"runs": len(runs)}, "out/drawn")


SITE = "PGA [m/s^2],return_period [year]\n0.05,2\n1,20\n5,400\n10,2000\n20,20000\n"


def legend_labels(figure: Any) -> list[str]:
    """Return the names in the legend of a figure, without what follows a comma."""
    (legend,) = figure.legends
    return [text.get_text().split(",")[0] for text in legend.get_texts()]
