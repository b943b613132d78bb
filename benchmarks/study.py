"""A study of very many runs: what is around the kernel, and the memory of a process."""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import thermobearing.structure.lanes as lanes
import thermobearing.structure.lanes as shaken
import thermobearing.structure.run as structure
from benchmarks.rows import Row, at_most, failed
from thermobearing.border.threads import one_blas_thread
from thermobearing.studies.definition.case import make_study
from thermobearing.studies.definition.record import Study
from thermobearing.studies.run.engine import run_study

AROUND, MEMORY = 15.0, 1000.0  # of the whole time [%]; [MB]
WAYS = {"one by one": 2000, "in lockstep": 10_000}  # runs
FACTORS = {
    "bearing": "shen-lhdr-bridge",
    "motion": "jra-ii-i-1",
    "ambient": {"distribution": "uniform", "low": "-30 degC", "high": "30 degC"},
    "scale": {"distribution": "lognormal", "median": 0.6, "cov": 0.4},
}


def study(samples: int, seed: int, mode: str) -> Study:
    """Temperatures and strengths by lot."""
    design = {"kind": "monte-carlo", "samples": samples, "seed": seed}
    design["lockstep"] = mode == "in lockstep"
    case = {"structure": "pier-p1", "duration": "40 s"}
    table = {"kind": "study", "name": "bench", "case": case, "design": design, "factors": FACTORS}
    return make_study(table, "bench")


def measured(mode: str) -> dict[str, float]:
    """Processor time of a whole study and of its kernels [s], peak memory [MB]; in this process."""
    spent = [0.0]

    def timed(march: Callable[..., Any]) -> Callable[..., Any]:
        def call(*arguments: Any) -> Any:
            begin = time.process_time()
            result = march(*arguments)
            spent[0] += time.process_time() - begin
            return result

        return call

    # Kernels are replaced by timed ones: the rest of the processor time is that around them.
    structure.newmark_march = timed(structure.newmark_march)
    lanes.lanes_march = timed(lanes.lanes_march)
    shaken.peaks_march = timed(shaken.peaks_march)
    with tempfile.TemporaryDirectory() as folder:
        # A small study first: compiling and imports do not count.
        run_study(study(20, 1, mode), Path(folder) / "first", jobs=1)
        spent[0], begin = 0.0, time.process_time()
        run_study(study(WAYS[mode], 2, mode), Path(folder) / "bench", jobs=1)
        total = time.process_time() - begin
    status = Path("/proc/self/status").read_text().split()
    peak = int(status[status.index("VmHWM:") + 1]) / 1e3
    return {"whole": total, "kernel": spent[0], "peak": peak}


def list_rows(mode: str) -> list[Row]:
    """Measure in a separate process, whose memory nothing else has used."""
    label = f"pier P1, 40 s, LHDR, {WAYS[mode]} runs {mode}, one process"
    command = [sys.executable, "-m", "benchmarks.study", mode]
    process = subprocess.run(command, capture_output=True, text=True, check=False)
    if process.returncode:
        reason = (process.stderr.strip().splitlines() or ["no message"])[-1]
        return [failed(label, reason, f"<= {AROUND:g} %")]
    results = json.loads(process.stdout.splitlines()[-1])
    around = 100.0 * (1.0 - results["kernel"] / results["whole"])
    duration = f"{1e3 * results['whole'] / WAYS[mode]:.2f} ms a run"
    return [
        at_most(f"{label}: share of the time around the kernel", around, AROUND, "%", duration),
        at_most(f"{label}: peak memory", results["peak"], MEMORY, "MB"),
    ]


def rows() -> list[Row]:
    """One by one and in lockstep."""
    return [row for mode in WAYS for row in list_rows(mode)]


if __name__ == "__main__":
    one_blas_thread()
    print(json.dumps(measured(sys.argv[1])))
