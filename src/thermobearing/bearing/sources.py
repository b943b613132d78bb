"""Numbers of a bearing that were not measured on its rubber or lead, by the words of their source.

Equivalent properties, forces in the cold and new bearing files say which of their numbers rest on
such a source.
"""

import re
from collections.abc import Mapping

NOT_MEASURED = {"assumed", "borrowed", "chosen"}  # words in sources
WORD = re.compile(r"[a-z]+")
CLAUSE = re.compile(rf"\b(?:{'|'.join(sorted(NOT_MEASURED))})\b[^;]*")
COEFFICIENTS = (  # with temperature: m_T and n_T
    "hysteresis.elastic_temperature_coefficient",
    "hysteresis.hysteretic_temperature_coefficient",
)
STIFFNESS = ("hysteresis.layer_stiffness", "lead.stiffness")
STRENGTH = ("lead.yield_stress",)
EXTRAPOLATED = "temperature_law"  # key of a law that a temperature is outside of
UNTESTED_VALUES = {  # of `compare_with_tests`: key of a tested range that a value is outside of
    "strain": "tested_range.strain",
    "ambient": "tested_range.ambient",
}
LEAD_EXTRAPOLATED = "lead.softening"  # key of E_2 where lead is colder than in its tests
VIRGIN_EXCESS = "scragging"  # key of the excess of virgin rubber, if of another compound


def is_assumed(source: str) -> bool:
    """Return whether a source says that a number was assumed, borrowed or chosen.

    >>> is_assumed("compound natural-rubber; chosen; tested cores have 7 to 20 MPa")
    True
    """
    return bool(NOT_MEASURED & set(WORD.findall(source)))


def assumed_clause(source: str, *, to_end: bool = False) -> str:
    """Return the words of a source from "assumed", "borrowed" or "chosen" on; else nothing.

    They end at the next semicolon, or at the end of the text (`to_end`).

    >>> assumed_clause("compound a; borrowed from shen-hdr; Table 3.4")
    'borrowed from shen-hdr'
    """
    match = CLAUSE.search(source)
    if not match:
        return ""
    return (source[match.start() :] if to_end else match[0]).strip()


def assumed_properties(sources: Mapping[str, str], *, at_reference: bool) -> tuple[str, ...]:
    """Return the dotted keys of assumed numbers on which stiffness, strength and damping rest.

    Those of the temperature coefficients do not count at the reference temperature.
    """
    keys = (*STIFFNESS, *STRENGTH, *(() if at_reference else COEFFICIENTS))
    return tuple(key for key in keys if is_assumed(sources.get(key, "")))


def is_never_tested(sources: Mapping[str, str]) -> bool:
    """Return whether no test is behind a bearing: its rubber has an assumed or chosen stiffness.

    >>> is_never_tested({"hysteresis.layer_stiffness": "chosen"})
    True
    """
    return is_assumed(sources.get(STIFFNESS[0], ""))
