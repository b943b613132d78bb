# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .case import ValidateCase as ValidateCase
from .case import make_validate_case as make_validate_case
from .hold_out import CrossValidation as CrossValidation
from .hold_out import HoldOutCase as HoldOutCase
from .hold_out import cross_validate as cross_validate
from .hold_out import make_hold_out_case as make_hold_out_case
from .hold_out import run_hold_out as run_hold_out
from .result import Validation as Validation
from .run import run_validate as run_validate
from .run import validate as validate
