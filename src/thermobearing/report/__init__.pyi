# What this room offers: read by type checkers, and by lazy_loader when it is first used.
from .html import html_page as html_page
from .pieces import Check as Check
from .pieces import Column as Column
from .pieces import Document as Document
from .pieces import Pieces as Pieces
from .pieces import Plot as Plot
from .pieces import ReportFigure as ReportFigure
from .pieces import ReportTable as ReportTable
from .pieces import Trace as Trace
from .template import arranged as arranged
from .template import document as document
