# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .ambient import Ambient as Ambient
from .bilinear import BilinearBearing as BilinearBearing
from .bilinear import list_bilinear as list_bilinear
from .bilinear import load_bilinear as load_bilinear
from .compound import Compound as Compound
from .compound import list_compounds as list_compounds
from .compound import load_compound as load_compound
from .exposure import Exposure as Exposure
from .library import changed_bearing as changed_bearing
from .library import list_bearings as list_bearings
from .library import load_bearing as load_bearing
from .library import save_bearing as save_bearing
from .model import Bearing as Bearing
from .model import Validity as Validity
from .new import new_bearing as new_bearing
from .scaling import bearing_of as bearing_of
from .scaling import compound_of as compound_of
