"""Rows of `thermobearing verify` as an HTML page."""

from collections.abc import Sequence

from thermobearing.report.html import html_page
from thermobearing.report.pieces import Block, Bullets, Document, Heading, Paragraph, TableBlock
from thermobearing.verify.report import explanations, headline, here, verified_table
from thermobearing.verify.rows import Verified


def verified_page(verified: Sequence[Verified], seconds: float) -> str:
    """Return all rows as one HTML file that needs nothing else."""
    red = explanations(verified)
    table = verified_table(verified)
    blocks: list[Block] = [
        Heading(1, "Verification"),
        Paragraph(headline(verified, seconds) + ".", "warning" if red else "answer"),
        *([Bullets(red, "warning")] if red else []),
        TableBlock("verification", table),
    ]
    return html_page(Document("thermobearing verify", here(), None, blocks, here()))
