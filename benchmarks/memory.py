"""Memory of a history of a million steps with the default histories kept."""

import json
import subprocess
import sys

from benchmarks.rows import Row, at_most, failed
from benchmarks.specimen import run_at, specimen_constants, table_34

LIMIT = 500.0  # [MB]
WHAT = "peak memory of a process with a history of a million steps"
DT = 0.000152  # [s]: Table 3.4 in just over a million steps
CODE = f"""
import json
from pathlib import Path
import thermobearing as tb

def peak():
    # ru_maxrss would be that of the parent, if larger: it survives fork and exec.
    status = Path("/proc/self/status").read_text().split()
    return 1024 * int(status[status.index("VmHWM:") + 1]) / 1e6

tb.run("shen-hdr-specimen", tb.cyclic_test(strain=[0.5], cycles=1)).cycles
before = peak()
result = tb.run("shen-hdr-specimen", tb.cyclic_test(dt={DT}))
after = peak()
kept = sum(variable.nbytes for variable in result.dataset.variables.values()) / 1e6
print(json.dumps([int(result["steps"][0]), before, kept, after]))
"""


def rows() -> list[Row]:
    """Measure in a separate process, so that the other benchmarks do not count."""
    run_at(specimen_constants(), table_34(), 23.0)  # compiling needs memory too: not there
    command = [sys.executable, "-c", CODE]
    process = subprocess.run(command, capture_output=True, text=True, check=False)
    if process.returncode:
        reason = (process.stderr.strip().splitlines() or ["no message"])[-1]
        return [failed(WHAT, reason, f"<= {LIMIT:g} MB")]
    steps, before, kept, after = json.loads(process.stdout)
    note = f"{steps:,} steps; {before:.0f} MB after a short test, dataset of {kept:.0f} MB"
    return [at_most(WHAT, after, LIMIT, "MB", note)]
