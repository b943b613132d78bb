# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .case import load_study as load_study
from .case import make_study as make_study
from .designs import plan as plan
from .record import Study as Study
