# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .case import SequenceCase as SequenceCase
from .case import load_sequence_case as load_sequence_case
from .case import make_sequence_case as make_sequence_case
from .result import SequenceResult as SequenceResult
from .run import run_sequence as run_sequence
