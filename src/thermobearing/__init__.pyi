# The public interface: read by type checkers, and by lazy_loader when a name is first used.
# Rooms first; each has its own list in its own stub.
from . import bearing as bearing
from . import border as border
from . import climate as climate
from . import cyclic as cyclic
from . import design as design
from . import earthquake as earthquake
from . import identify as identify
from . import intake as intake
from . import model as model
from . import motions as motions
from . import reproduce as reproduce
from . import results as results
from . import sequences as sequences
from . import structure as structure
from . import studies as studies
from . import tables as tables
from . import validate as validate
from .bearing.ambient import Ambient as Ambient
from .bearing.library import load_bearing as load_bearing
from .border.errors import InputError as InputError
from .border.errors import OutputError as OutputError
from .cyclic.case import load_case as load_case
from .cyclic.protocol import cyclic_test as cyclic_test
from .cyclic.run import run as run
from .design.factors import temperature_factors as temperature_factors
from .earthquake.study import bridge as bridge
from .earthquake.study import hybrid as hybrid
from .earthquake.study import sweep as sweep
from .identify.records.record import load_test as load_test
from .identify.run import identify_bearing as identify_bearing
from .loading import load_result as load_result
from .model.element import BearingElement as BearingElement
from .model.element import element as element
from .motions.library import load_motion as load_motion
from .reporting import make_report as make_report
from .sequences.run import sequence as sequence
from .studies.run.engine import study as study

__version__: str
