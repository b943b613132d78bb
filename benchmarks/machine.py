"""Where the numbers come from: processor, what else it does, and versions."""

import os
import platform
from importlib.metadata import version
from pathlib import Path

import thermobearing

PACKAGES = ("numpy", "scipy", "numba", "xarray")


def processor() -> str:
    """Model name of the processor, as well as the system tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def load() -> str:
    """Processes that run or wait for a core, the mean of the last five minutes."""
    try:
        return f"{os.getloadavg()[1]:.1f}"
    except (AttributeError, OSError):
        return "unknown"


def machine() -> dict[str, str]:
    """Processor, cores, load, system and versions."""
    about = {
        "processor": processor(),
        "cores": str(os.cpu_count()),
        "load": load(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "thermobearing": thermobearing.__version__,
    }
    return about | {name: version(name) for name in PACKAGES}
