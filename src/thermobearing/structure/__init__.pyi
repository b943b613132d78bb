# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .model import Structure as Structure
from .model import fixed_base as fixed_base
from .model import list_structures as list_structures
from .model import load_structure as load_structure
from .result import StructureResult as StructureResult
from .result import examine_structure as examine_structure
