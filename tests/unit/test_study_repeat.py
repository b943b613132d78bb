"""One run of a study in full: the same numbers as the study has."""

import numpy as np

import thermobearing as tb
from thermobearing.earthquake.run import run_task
from thermobearing.studies.definition.case import make_study
from thermobearing.studies.definition.designs import plan
from thermobearing.studies.run.engine import repeat_run
from thermobearing.studies.run.prepare import Preparer

TABLE = {
    "kind": "study",
    "name": "p1",
    "case": {"duration": "6 s"},
    "factors": {
        "bearing": ["shen-bilinear-bridge", "shen-hdr-bridge"],
        "motion": "jra-ii-i-1",
        "scale": [0.5, 1.5],
        "ambient": "-20 degC",
    },
}


def test_a_run_again_has_the_same_bits_and_is_what_bridge_does() -> None:
    study = make_study(TABLE, "test")
    row = plan(study).to_dict("records")[3]
    history = run_task(Preparer(study).make_task(row))
    again = repeat_run(study, 3)
    moved = again.dataset["bearing_displacement"].values[0]
    assert np.array_equal(moved, history.bearing(0)["displacement"][::2].astype(moved.dtype))
    motion = {"name": "jra-ii-i-1", "factor": 1.5}
    bridge = tb.bridge("shen-hdr-bridge", motion, -20, duration=6)
    assert np.array_equal(moved, bridge.dataset["bearing_displacement"].values[0])
    assert "factor = 1.5" in again.dataset.attrs["case"]
    assert again.table["bearing"].tolist() == ["shen-hdr-bridge"]
