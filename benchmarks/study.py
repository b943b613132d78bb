"""A study of very many runs: what is around the kernel, and the memory of a process."""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import thermobearing.structure.run as structure
from benchmarks.rows import Row, at_most, failed
from thermobearing.border.threads import one_blas_thread
from thermobearing.studies import Study, make_study, run_study

AROUND, MEMORY = 15.0, 1000.0  # of the time of the kernel [%]; [MB]
RUNS, SHARD = 2000, 100  # in shards as those of 10^4 runs
WHAT = f"pier P1, 40 s, LHDR, {RUNS} runs, one process"
FACTORS = {
    "bearing": "shen-lhdr-bridge",
    "motion": "jra-ii-i-1",
    "ambient": {"distribution": "uniform", "low": "-30 degC", "high": "30 degC"},
    "scale": {"distribution": "lognormal", "median": 0.6, "cov": 0.4},
}


def study(samples: int, seed: int) -> Study:
    """Temperatures and strengths by lot."""
    design = {"kind": "monte-carlo", "samples": samples, "seed": seed}
    case = {"structure": "pier-p1", "duration": "40 s"}
    table = {"kind": "study", "name": "bench", "case": case, "design": design, "factors": FACTORS}
    return make_study(table, "bench")


def measured(runs: int = RUNS) -> dict[str, float]:
    """Processor time of a whole study and of its kernel [s], peak memory [MB]; in this process."""
    march, spent = structure.newmark_march, [0.0]

    def timed(*given: object) -> object:
        begin = time.process_time()
        done = march(*given)
        spent[0] += time.process_time() - begin
        return done

    structure.newmark_march = timed
    with tempfile.TemporaryDirectory() as folder:
        run_study(study(20, 1), Path(folder) / "first", jobs=1, size=SHARD)
        spent[0], begin = 0.0, time.process_time()
        run_study(study(runs, 2), Path(folder) / "bench", jobs=1, size=SHARD)
        whole = time.process_time() - begin
    status = Path("/proc/self/status").read_text().split()
    peak = int(status[status.index("VmHWM:") + 1]) / 1e3
    return {"whole": whole, "kernel": spent[0], "peak": peak}


def rows() -> list[Row]:
    """In a process of its own, whose memory nobody else had."""
    command = [sys.executable, "-m", "benchmarks.study"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        reason = (done.stderr.strip().splitlines() or ["no message"])[-1]
        return [failed(WHAT, reason, f"<= {AROUND:g} %")]
    found = json.loads(done.stdout.splitlines()[-1])
    around = 100.0 * (found["whole"] / found["kernel"] - 1.0)
    each = f"{1e3 * found['whole'] / RUNS:.1f} ms a run"
    return [
        at_most(f"{WHAT}: around the kernel", around, AROUND, "%", each),
        at_most(f"{WHAT}: peak memory", found["peak"], MEMORY, "MB"),
    ]


if __name__ == "__main__":
    one_blas_thread()
    print(json.dumps(measured()))
