# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .columns import read_columns as read_columns
