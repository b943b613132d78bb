# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .bounds import BoundModel as BoundModel
from .bounds import bound_models as bound_models
from .bounds import bounds_study as bounds_study
from .case import DesignCase as DesignCase
from .case import load_design_case as load_design_case
from .case import make_design_case as make_design_case
from .factors import scale_study as scale_study
from .factors import scaled_bearing as scaled_bearing
from .factors import temperature_factors as temperature_factors
from .result import Design as Design
from .run import run_design as run_design
from .sizing import EqualBearing as EqualBearing
from .sizing import equal_bearing as equal_bearing
