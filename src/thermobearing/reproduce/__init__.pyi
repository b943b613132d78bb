# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .claims import Claim as Claim
from .claims import Flip as Flip
from .claims import Row as Row
from .claims import Verdict as Verdict
from .claims import find_flip as find_flip
from .claims import load_claims as load_claims
from .claims import make_row as make_row
from .claims import verdict_of as verdict_of
from .result import Reproduction as Reproduction
from .run import reproduce_source as reproduce_source
from .runs import Runs as Runs
