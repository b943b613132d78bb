"""What belongs to the site of a study: how often it shakes, how cold it is."""

from pathlib import Path
from typing import Any

from thermobearing.border.errors import InputError, nearest
from thermobearing.climate import generate_weather, list_climates, read_weather
from thermobearing.core.records import Floats
from thermobearing.studies.hazard import Hazard, load_hazard
from thermobearing.studies.levels import YEARS
from thermobearing.studies.result import StudyResult


def site_hazard(result: StudyResult, path: Path) -> Hazard:
    """A hazard curve in the measure that the study counts by."""
    return load_hazard(path, result.study.factors.scale.measure)


def site_temperatures(name_or_path: str) -> Floats:
    """Hourly temperatures of a site: of a climate by name or TOML, or of a weather file [degC].

    Raises
    ------
    InputError : no such climate, no such file.
    """
    if name_or_path in list_climates() or name_or_path.endswith(".toml"):
        return generate_weather(name_or_path, YEARS).temperature
    return read_weather(name_or_path).temperature


def choice(option: str, given: Any, known: tuple[str, ...]) -> None:
    """InputError unless a word is one of those that are known."""
    if given not in known:
        raise InputError(f'{option} "{given}"{nearest(str(given), known)}')
