# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .case import IdentifyCase as IdentifyCase
from .case import make_identify_case as make_identify_case
from .fit.synthetic import synthetic_record as synthetic_record
from .records.checks import CheckReport as CheckReport
from .records.checks import check_test as check_test
from .records.record import TestRecord as TestRecord
from .records.record import load_test as load_test
from .records.record import record_from_arrays as record_from_arrays
from .result import Identification as Identification
from .run import identify_bearing as identify_bearing
from .run import run_identify as run_identify
from .uncertainty.posterior import Band as Band
from .uncertainty.posterior import Forecast as Forecast
from .uncertainty.posterior import forecast as forecast
from .uncertainty.samples import posterior_bearings as posterior_bearings
