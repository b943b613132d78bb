"""Rewrite the regression baselines: `python -m tests.regression.regenerate "reason"`.

Run it only when a change of the numbers is meant; the reason is kept in the baseline.
"""

import json
import sys
from datetime import date
from pathlib import Path
from typing import Any

import thermobearing as tb

BASELINE = Path(__file__).with_name("baselines") / "cyclic.json"
CASES: dict[str, dict[str, Any]] = {
    "specimen, conservative, exact": {},
    "specimen, published, euler": {"scheme": "published", "integrator": "euler"},
    "specimen, dissipated heat, full stack": {"heat_source": "dissipation", "stack": "full"},
    "bridge": {"bearing": "shen-hdr-bridge"},
    "lead specimen": {"bearing": "shen-lhdr-specimen"},
    "lead specimen, published": {"bearing": "shen-lhdr-specimen", "scheme": "published"},
    "lead rubber bearing": {"bearing": "lrb-example"},
    "single temperature": {"bearing": "shen-lhdr-specimen", "model": "single-temperature"},
}


def compute() -> dict[str, list[list[float]]]:
    """G_eq, h_eq, energy and outer and inner temperature of each cycle of a short test."""
    test = tb.cyclic_test(strain=[1.0, 2.5], cycles=2, rest=600.0)
    columns = ["G_eq_MPa", "h_eq", "energy_kN_mm", "rubber1_degC", "rubber3_degC"]
    return {
        name: tb.run(**{"bearing": "shen-hdr-specimen", "test": test, "ambient": -20.0} | options)
        .cycles[columns]
        .to_numpy()
        .tolist()
        for name, options in CASES.items()
    }


def main() -> None:
    """Write the baseline with its date, version and reason."""
    if len(sys.argv) != 2:
        sys.exit('usage: python -m tests.regression.regenerate "reason for the new numbers"')
    BASELINE.parent.mkdir(exist_ok=True)
    content = {
        "reason": sys.argv[1],
        "date": date.today().isoformat(),
        "version": tb.__version__,
        "values": compute(),
    }
    BASELINE.write_text(json.dumps(content, indent=1) + "\n")


if __name__ == "__main__":
    main()
