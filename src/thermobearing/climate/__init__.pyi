# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .generator import Climate as Climate
from .generator import ColdSpells as ColdSpells
from .generator import generate_weather as generate_weather
from .generator import list_climates as list_climates
from .generator import load_climate as load_climate
from .hourly import Hourly as Hourly
from .readers import read_weather as read_weather
