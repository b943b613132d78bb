# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .claims import Claim as Claim
from .claims import load_claims as load_claims
from .flips import Flip as Flip
from .flips import find_flip as find_flip
from .judge import Verdict as Verdict
from .judge import verdict_of as verdict_of
from .result import Reproduction as Reproduction
from .rows import Row as Row
from .rows import make_row as make_row
from .run import reproduce_source as reproduce_source
from .runs import Runs as Runs
