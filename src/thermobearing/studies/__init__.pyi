# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .case import load_study as load_study
from .case import make_study as make_study
from .designs import plan as plan
from .engine import run_study as run_study
from .peaks import measure as measure
from .prepare import Preparer as Preparer
from .record import Study as Study
from .shard import run_shard as run_shard
from .status import Status as Status
from .status import study_status as study_status
