"""First commands after installing in a clone, each of which compiles, and the ones after them.

Times are of the processor, which other programs on the machine change less than those on the wall.
"""

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import llvmlite.binding as llvm

from benchmarks.commands import CLI, CommandError, Elapsed, processor_of_children, run_python
from benchmarks.rows import Row, at_most, failed

WARM_LIMIT = 3.0  # [s]
WARM = "next `thermobearing cyclic --no-figures`, three temperatures, on the wall"
HOT_LIMIT = 24.0  # [kB], of an instruction cache of 32 kB
HOT = "machine code that every step runs, on a line"
COLD = "first `thermobearing cyclic --no-figures`, three temperatures: processor time"
PLANE = """
import thermobearing as tb
tb.element("shen-lhdr-bridge", ambient=-20.0, components=2).set_trial((1.0, 1.0), dt=0.1)
"""
BRIDGE = """
import thermobearing as tb
tb.bridge("shen-lhdr-bridge", "jra-ii-i-1", -20.0, duration=0.1)
"""
STUDY = """
kind = "study"
name = "first"
[case]
structure = "pier-p1"
duration = "15 s"
[design]
kind = "sobol"
samples = 64
paired = false
[factors]
bearing = ["shen-hdr-bridge", "shen-bilinear-bridge"]
motion = "jra-ii-i-1"
[factors.ambient]
climate = "cold-town"
years = 2
[factors."bearing.K_r"]
distribution = "lognormal"
median = 1.0
cov = 0.1
"""


def compile_into(compiled: str) -> dict[str, str]:
    """Return the variables of a process that compiles what it runs, into a folder."""
    return {"NUMBA_CACHE_DIR": compiled, "THERMOBEARING_KERNELS": "jit"}


def _serve(compiled: str) -> Elapsed:
    """Start a server, and end it when it says that it listens."""
    begin = processor_of_children()
    command = [sys.executable, "-c", CLI, "serve", "shen-hdr-bridge", "--ambient=-20", "--port=0"]
    with subprocess.Popen(
        command,
        env={**os.environ, **compile_into(compiled)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    ) as server:
        assert server.stdout is not None
        listens = any("port" in line for line in server.stdout)
        server.send_signal(signal.SIGINT)
        server.communicate()
    if not listens:
        raise CommandError("the server ended before it listened")
    return Elapsed(0.0, processor_of_children() - begin)


def _hot_size(compiled: Path) -> float:
    """Return the size of the three parts of a step, without what most steps do not run [kB]."""
    files = list(compiled.glob("*/*/thermobearing_core_step_*.o"))
    if not files:
        raise CommandError("no machine code of a step was compiled")
    size = 0
    for file in files:
        sections = llvm.ObjectFileRef.from_data(file.read_bytes()).sections()
        size += sum(
            section.size()
            for section in sections
            if section.is_text() and b"unlikely" not in section.name()
        )
    return size / 1e3


def rows() -> list[Row]:
    """Cold with an empty folder for compiled code each; warm is the fastest of three.

    Libraries that were built ahead of time are not used: nothing would be compiled.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "study.toml").write_text(STUDY, encoding="utf-8")

        def cyclic(compiled: str, number: int = 0) -> Elapsed:
            target = str(folder / f"result{number}")
            arguments = ("cyclic", "--no-figures", "-q", "-o", target)
            return run_python(CLI, arguments, **compile_into(compiled))

        def study(compiled: str) -> Elapsed:
            arguments = ("study", str(folder / "study.toml"), "--dry-run")
            return run_python(CLI, arguments, **compile_into(compiled))

        def kernels(compiled: str) -> Elapsed:
            return run_python(
                "from kernels.__main__ import main; main(['cache'])",
                **compile_into(compiled),
            )

        commands: dict[str, tuple[Callable[[str], Elapsed], float]] = {
            COLD: (cyclic, 12.0),
            "first bridge": (lambda compiled: run_python(BRIDGE, **compile_into(compiled)), 15.0),
            "first dry run of a study": (study, 15.0),
            "first step in a plane": (
                lambda compiled: run_python(PLANE, **compile_into(compiled)),
                15.0,
            ),
            "first `thermobearing serve` until it listens": (_serve, 15.0),
            "all kernels for this machine, `python -m kernels cache`": (kernels, 60.0),
        }
        measured = []
        for number, (label, (run, limit)) in enumerate(commands.items()):
            try:
                spent = run(str(folder / f"compiled{number}")).processor
                measured.append(at_most(label, spent, limit, "s"))
            except CommandError as error:
                measured.append(failed(label, str(error), f"<= {limit:g} s"))
        if measured[0].value is None:
            return measured
        compiled = folder / "compiled0"
        warm = sorted(cyclic(str(compiled), number) for number in (1, 2, 3))
        note = f"median {warm[1].wall:.2f} s, processor {warm[0].processor:.2f} s"
        measured.append(at_most(WARM, warm[0].wall, WARM_LIMIT, "s", note))
        try:
            measured.append(at_most(HOT, _hot_size(compiled), HOT_LIMIT, "kB"))
        except CommandError as error:
            measured.append(failed(HOT, str(error), f"<= {HOT_LIMIT:g} kB"))
        return measured
