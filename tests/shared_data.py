"""The real records that tests may use but the project may not contain."""

import os
from pathlib import Path

import pytest

from tests.skip_reasons import NO_RECORDS as ABSENT

BESIDE = Path(__file__).parents[2] / "shared"


def shared_data(name: str) -> Path:
    """Path of a shared file such as "bearing_tests/Test_2D_shear.csv"; skips where it is absent.

    The folder is ../shared next to the repository, or where THERMOBEARING_SHARED says.
    """
    folder = Path(os.environ.get("THERMOBEARING_SHARED") or BESIDE)
    if not (folder / "data").is_dir():
        pytest.skip(f"{ABSENT}: {folder}; THERMOBEARING_SHARED may name it")
    path = folder / "data" / name
    if not path.exists():
        pytest.skip(f"{path} is not there; THERMOBEARING_SHARED may name the folder that holds it")
    return path
