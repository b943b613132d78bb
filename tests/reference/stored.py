"""Write data/verify/references.json: `python -m tests.reference.stored`.

Needs scikit-fem and openseespy. The number of the real test is that of docs/measured.json.
"""

import json
import tempfile
from pathlib import Path
from typing import Any

from thermobearing.border.library import data_path
from thermobearing.verify import references

MEASURED = Path(__file__).parents[2] / "docs" / "measured.json"
REAL_TEST = "NRMSE of the real HDR test, with scragging"


def real_test() -> dict[str, Any]:
    values = {row["what"]: row["value"] for row in json.loads(MEASURED.read_text())}
    note = "The data of the test are not part of the package; the tests of the project record it."
    return {"error": float(values[REAL_TEST]), "note": note}


def computed() -> dict[str, Any]:
    bearings = {bearing for bearing, _ in references.ELEMENTS.values()}
    elements = {bearing: references.compute_elements(bearing) for bearing in sorted(bearings)}
    with tempfile.TemporaryDirectory() as folder:
        script = references.opensees_script(Path(folder))
    force = references.run_opensees()[references.EVERY - 1 :: references.EVERY]
    return {
        "finite_elements": {"script": references.elements_digest(), **elements},
        "opensees": {
            "script": references.script_digest(script),
            "force": [round(float(value), 7) for value in force],
        },
        "real_test": real_test(),
        "platform_cyclic": [value.hex() for value in references.cyclic_numbers()],
        "platform_earthquake": [value.hex() for value in references.earthquake_numbers()],
    }


if __name__ == "__main__":
    text = json.dumps(computed(), indent=1)
    data_path("verify", references.STORED).write_text(text + "\n", encoding="utf-8")
