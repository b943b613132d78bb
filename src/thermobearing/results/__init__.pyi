# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .metrics import CycleMeasures as CycleMeasures
from .metrics import measure_cycle as measure_cycle
from .metrics import measure_history as measure_history
from .profiles import overlay as overlay
from .saved import SavedResult as SavedResult
