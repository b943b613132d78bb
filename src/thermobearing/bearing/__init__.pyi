# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .ambient import Ambient as Ambient
from .bilinear import BilinearBearing as BilinearBearing
from .bilinear import list_bilinear as list_bilinear
from .bilinear import load_bilinear as load_bilinear
from .library import list_bearings as list_bearings
from .library import load_bearing as load_bearing
from .model import Bearing as Bearing
from .validity import Validity as Validity
