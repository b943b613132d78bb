# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .errors import InputError as InputError
from .errors import OutputError as OutputError
