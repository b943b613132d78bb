# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .case import EarthquakeCase as EarthquakeCase
from .case import load_earthquake_case as load_earthquake_case
from .case import make_earthquake_case as make_earthquake_case
from .result import EarthquakeResult as EarthquakeResult
from .run import run_earthquake as run_earthquake
from .soaking import bearing_weather as bearing_weather
from .study import bridge as bridge
from .study import compare_models as compare_models
from .study import hybrid as hybrid
