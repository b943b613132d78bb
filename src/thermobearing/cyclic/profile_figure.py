"""Temperature through the height of the bearing, and of the lead core beside it."""

from matplotlib.figure import Figure

from thermobearing.cyclic.result import Result
from thermobearing.cyclic.time_axis import TimeAxis
from thermobearing.results.profiles import MOST_PROFILES, ProfilePanel, draw_profile_panels


def draw_profiles(result: Result, title: str, titles: list[str]) -> Figure:
    """One panel per ambient temperature, one line per amplitude (Fig. 4.10, 5.17)."""
    data, ambient = result.dataset, result["ambient"].values
    time = TimeAxis(result)
    shown = time.loading_ends(MOST_PROFILES)
    panels = []
    for run, name in enumerate(titles):
        lines = []
        for place, (number, _) in enumerate(shown):
            row = time.last_row(run, number)
            if row is None:
                continue
            lead = float(data["lead_temperature"].values[run, row]) if result.has_lead else None
            lines.append((place, data["temperature"].values[run, row], lead))
        panels.append(ProfilePanel(name, float(ambient[run]), data, lines))
    count = len(ambient)
    size = (max(5.5, 1.9 + 2.5 * count), 5.2)
    return draw_profile_panels(title, size, count, panels, [name for _, name in shown])
