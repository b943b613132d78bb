# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .result import Intake as Intake
from .result import Intakes as Intakes
from .run import take_in as take_in
