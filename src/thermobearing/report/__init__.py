"""A document to hand over, of any result: what is said once, written as HTML, PDF or workbook.

No physics and no analysis here. Each analysis says what its document holds in its own
`report.py`, as `Pieces`; a template puts them in order; `html` and `pdf` write the same `Document`.
"""
