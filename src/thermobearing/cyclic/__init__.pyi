# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .case import Case as Case
from .case import Rig as Rig
from .case import end_state as end_state
from .case import load_case as load_case
from .case import load_rig as load_rig
from .case import make_case as make_case
from .discretisation import CellsError as CellsError
from .discretisation import cells_error as cells_error
from .equivalent import bilinear_parameters as bilinear_parameters
from .protocol import CyclicTest as CyclicTest
from .protocol import cyclic_test as cyclic_test
from .result import Result as Result
from .run import compare_models as compare_models
from .run import run_case as run_case
