"""How long a structure with several bearing lines takes to compile: any number, once."""

import json
import subprocess
import sys
import tempfile

from benchmarks.rows import Row, at_most, failed, plain

FIRST = "first earthquake of pier P1 with one bearing line (compiles)"
LIMIT = 1.0  # [s]
COUNTS = (1, 2, 6)
CODE = """
import json, sys, time
from tests.unit.test_structure_matrices import DT, make_pier
from tests.verification.structures import read_ground, real_bearing, shaken
ground, constants = read_ground("jra-ii-i-1", DT, 5.0), real_bearing("shen-hdr-bridge")
found = []
for count in json.loads(sys.argv[1]):
    begin = time.process_time()
    shaken(make_pier([1] * count), constants, ground, DT)
    found.append(time.process_time() - begin)
print(json.dumps(found))
"""


def rows() -> list[Row]:
    """One process with an empty folder for compiled code, the numbers of lines in turn."""
    with tempfile.TemporaryDirectory() as name:
        command = [
            "env",
            f"NUMBA_CACHE_DIR={name}",
            sys.executable,
            "-c",
            CODE,
            json.dumps(COUNTS),
        ]
        process = subprocess.run(command, capture_output=True, text=True, check=False)
    if process.returncode:
        reason = (process.stderr.strip().splitlines() or ["no message"])[-1]
        return [failed(FIRST, reason, f"<= {LIMIT:g} s")]
    first, *later = json.loads(process.stdout.splitlines()[-1])
    later_by_count = zip(COUNTS[1:], later, strict=True)
    return [
        plain(FIRST, first, "s", "processor"),
        *(at_most(f"the next with {n} lines", taken, LIMIT, "s") for n, taken in later_by_count),
    ]
