"""Accelerograms in all formats, written for tests. No tests."""

from pathlib import Path

import numpy as np

DT, COUNT = 0.01, 400


def shaking(
    pga: float = 300.0, count: int = COUNT
) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
    place = np.arange(count) / (count - 1)
    values = np.sin(np.pi * place) * np.sin(40.0 * np.pi * place)
    return np.asarray(pga * values / np.abs(values).max())


def csv_rows(pga: float = 300.0) -> list[str]:
    return [f"{i * DT:.3f},{value:.5f}" for i, value in enumerate(shaking(pga))]


def csv_text(header: str = "t_s,acc_gal", pga: float = 300.0) -> str:
    return "\n".join([header, *csv_rows(pga)]) + "\n"


def one_column(header: str = "", pga: float = 300.0) -> str:
    return "\n".join([*([header] if header else []), *(f"{v:.6f}" for v in shaking(pga))]) + "\n"


def at2_text(
    pga: float = 0.3,
    line: str = "NPTS=   400, DT=   .0100 SEC,",
    unit: str = "ACCELERATION TIME SERIES IN UNITS OF G",
    end: str = "\n",
) -> str:
    cells = [f"{value:15.7E}" for value in shaking(pga)]
    rows = ["".join(cells[i : i + 5]) for i in range(0, COUNT, 5)]
    head = [
        "PEER NGA STRONG MOTION DATABASE RECORD",
        "Somewhere, 1/1/2000, Station, 000",
        unit,
        line,
    ]
    return end.join([*head, *rows]) + end


def knet_text(
    frequency: str = "100Hz",
    scale: str = "2000(gal)/1000000",
    duration: str = "4",
    largest: float = 300.0,
    memo: str = "Memo.",
    offset: int = 5000,
    direction: str = "N-S",
) -> str:
    values = shaking(300.0)
    counts = np.round((values - values.mean()) * 500.0).astype(int) + offset
    counts[-1] -= counts.sum() - offset * len(counts)  # so that the mean is the offset
    cells = [f"{count:9d}" for count in counts]
    entries = {
        "Origin Time": "2011/03/11 14:46:00",
        "Lat.": "38.103",
        "Long.": "142.860",
        "Depth. (km)": "24",
        "Mag.": "9.0",
        "Station Code": "ABC001",
        "Station Lat.": "35.0",
        "Station Long.": "139.0",
        "Station Height(m)": "10",
        "Record Time": "2011/03/11 14:47:28",
        "Sampling Freq(Hz)": frequency,
        "Duration Time(s)": duration,
        "Dir.": direction,
        "Scale Factor": scale,
        "Max. Acc. (gal)": f"{largest:.3f}",
        "Last Correction": "2011/03/11 14:47:13",
    }
    head = [f"{key:18}{value}" for key, value in entries.items()]
    rows = ["".join(cells[i : i + 8]) for i in range(0, COUNT, 8)]
    return "\n".join([*head, memo, *rows]) + "\n"


def jma_text(
    rate: str = " SAMPLING RATE= 100Hz",
    unit: str = " UNIT  = gal(cm/s/s)",
    titles: str = " NS,EW,UD",
    pga: float = 300.0,
) -> str:
    head = ["SITE CODE= 9CF宇城市松橋町 ,32.7,130.8", " LAT.=   32.6", " LON.=  130.7", rate, unit]
    rows = [f"{v:.4f},{-0.5 * v:.4f},{0.1 * v:.4f}" for v in shaking(pga)]
    return "\n".join([*head, "INITIAL TIME = 2016 04 14 21 26 20", titles, *rows]) + "\n"


def write(path: Path, text: str, encoding: str = "utf-8") -> Path:
    path.write_bytes(text.encode(encoding))
    return path
