# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .earlier import BilinearParameters as BilinearParameters
from .earlier import bilinear_constants as bilinear_constants
from .element import BearingElement as BearingElement
from .element import Trial as Trial
from .options import BearingModel as BearingModel
from .options import EndFace as EndFace
from .options import ModelOptions as ModelOptions
from .options import Side as Side
from .options import build_model as build_model
