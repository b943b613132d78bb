"""What the columns of a plan are: unit and meaning of each, for the files of a study."""

import pandas as pd

from thermobearing.studies.columns import AMBIENT, HOUR, SAMPLE, targets_of
from thermobearing.studies.intensity import COLUMNS
from thermobearing.studies.parquet import About
from thermobearing.studies.record import Study

KNOWN = {
    "run": About("1", "number of the run, its row in the plan"),
    "id": About("", "digest of all that goes into the run"),
    "seed": About("1", "of what the run draws by lot"),
    "sample": About("1", "number of the draw"),
    "matrix": About("", "where it belongs in Saltelli's arrangement"),
    "structure": About("", "name of the structure"),
    "bearing": About("", "name of the bearing"),
    SAMPLE: About("1", "number of the sample of a posterior, -1 of a bearing without"),
    "motion": About("", "name of the ground motion"),
    "scale": About("1", "what multiplies the ground motion"),
    COLUMNS["PGA"]: About("m/s2", "peak acceleration of the scaled motion"),
    COLUMNS["PGV"]: About("m/s", "peak velocity of the scaled motion"),
    COLUMNS["Sa"]: About("m/s2", "spectral acceleration of the scaled motion"),
    AMBIENT: About("degC", "temperature of the air"),
    HOUR: About("1", "hour of the weather when the earthquake comes"),
}


def about_plan(study: Study, runs: pd.DataFrame) -> dict[str, About]:
    """What each column of the plan of a study is.

    Parameters
    ----------
    study, runs : and its plan.
    """
    found = {}
    units = {target.name: target.unit for target in targets_of(study)}
    for name in map(str, runs.columns):
        factor = study.factors.numbers.get(name)
        if factor is None:
            found[name] = KNOWN.get(name, About())
        elif factor.of == "factor":
            found[name] = About("1", f"what multiplies {name}")
        else:
            found[name] = About(units[name] or "1", name)
    return found
