# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .case import ValidateCase as ValidateCase
from .case import make_validate_case as make_validate_case
from .result import Validation as Validation
from .run import run_validate as run_validate
from .run import validate as validate
