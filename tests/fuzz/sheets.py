"""Tables of samples as laboratories write them: text, workbooks. No tests."""

import math
from functools import cache
from typing import Any

from hypothesis import strategies as st


def rows(header: str, columns: Any, count: int) -> str:
    """CSV text: a header, and `columns(k)` for each row."""
    lines = [",".join(f"{value:.6g}" for value in columns(k)) for k in range(count)]
    return "\n".join([header, *lines]) + "\n"


def _cycle(k: int) -> tuple[float, float, float, float]:
    """Time, displacement, force and a temperature of a test of two cycles in 2 s."""
    angle = 2.0 * math.pi * k / 40
    return 0.025 * k, 30.0 * math.sin(angle), 60 * math.sin(angle + 0.2), 20 + 0.02 * k


TEST = rows("time_s,displacement_mm,force_kN,inner_degC", _cycle, 81)
MOVED = rows("time_s,displacement_mm", lambda k: (0.1 * k, 9 * math.sin(0.1 * math.pi * k)), 21)
NIGHT = rows("time_h,temperature_degC", lambda k: (k, 5.0 - k), 13)


def _commas(text: str) -> str:
    return text.replace(",", ";").replace(".", ",")


def _stamped(text: str) -> str:
    head, *lines = text.splitlines()
    reported = [head.replace("time_s", "Uhrzeit")]
    for k, line in enumerate(lines):
        second = (86_398 + k // 20) % 86_400
        clock = f"{second // 3600:02d}:{second % 3600 // 60:02d}:{second % 60:02d}"
        reported.append(f"{clock},{line.split(',', 1)[1]}")
    return "\n".join(reported) + "\n"


LABORATORY = {
    "semicolons": _commas(TEST),
    "tabs": "Zeit [s]\tWeg\tKraft\tT3\ns\tcm\ttonf\t°C\n"
    + TEST.split("\n", 1)[1].replace(",", "\t"),
    "stamps": _stamped(TEST),
    "head": "Versuch 7\n# Kommentar\n\n" + _commas(TEST).replace("inner_degC", "Kammer [°C]"),
    "blocks": TEST + "\nBlock 2,,,\n" + TEST,
    "Japanese": TEST.replace(TEST.split("\n", 1)[0], "時間(秒),変位[mm],荷重[kN],室温(℃)"),
    "bare": TEST.split("\n", 1)[1].replace(",", "  "),
}


def laboratory_files() -> st.SearchStrategy[str]:
    """Tables as laboratories have them."""
    return st.sampled_from([TEST, *LABORATORY.values()])


@cache
def workbook() -> bytes:
    """The test as an Excel workbook; its first bytes alone where no reader is installed."""
    import io

    try:
        import openpyxl
    except ImportError:
        return b"PK\x03\x04"
    book = openpyxl.Workbook()
    for line in TEST.splitlines():
        cells = line.split(",")
        book.active.append(cells if "_" in line else [float(cell) for cell in cells])
    held = io.BytesIO()
    book.save(held)
    return held.getvalue()


MEASURED = rows("displacement_mm,force_kN", lambda k: _cycle(k)[1:3], 81)
