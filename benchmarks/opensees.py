"""OpenSees: one mass on a LeadRubberX bearing whose lead heats, in a process of its own."""

import json
import subprocess
import sys

from benchmarks.rows import Row, at_least, failed, plain
from benchmarks.specimen import step_microseconds

WHAT = "OpenSees LeadRubberX with lead heating, one-mass transient"
LIMIT = 100.0


def rows() -> list[Row]:
    """Time per step without and with recorded histories, and the ratios to our step."""
    before, _ = step_microseconds()
    command = [sys.executable, "-m", "benchmarks.opensees_model"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        reason = (done.stderr.strip().splitlines() or ["no message"])[-1]
        return [failed(WHAT, reason, f">= {LIMIT:g}")]
    found = json.loads(done.stdout.splitlines()[-1])
    fast = min(before, step_microseconds()[0])
    heated = f"lead {found['rise']:.0f} K warmer, {found['iterations']} iterations a step"
    note = f"ours {fast:.3f} us in the same run, histories kept"
    bare, recorded = found["bare"], found["recorded"]
    return [
        plain(f"{WHAT}, nothing kept", bare, "us", heated),
        plain(f"{WHAT}, three recorders", recorded, "us", heated),
        at_least("ratio OpenSees, nothing kept / coupled step", bare / fast, LIMIT, note=note),
        at_least("ratio OpenSees, recorded / coupled step", recorded / fast, LIMIT, note=note),
    ]
