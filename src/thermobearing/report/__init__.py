"""Reports of any result: the content once, written as HTML, PDF or workbook.

No physics and no analysis here. Each analysis defines the content of its report in its own
`report.py`, as `Pieces`; a template puts them in order; `html` and `pdf` write the same `Document`.
"""
