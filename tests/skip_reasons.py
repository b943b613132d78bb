"""Why tests skip on a machine that lacks an optional program, and how many for each reason.

Every other reason is a fault of the tests on a machine with Python and make only: with
THERMOBEARING_BARE set, as tests/bare.sh is used in CI, it fails the run.
"""

from collections import Counter
from collections.abc import Iterable

from docs.builder.chromium import MISSING as NO_BROWSER

NO_NODE = "there is no JavaScript engine: neither node nor the browser's driver brings one"
NO_OPENSEES = (
    "OpenSees cannot be imported: install openseespy, which there is for 64-bit Linux, Windows "
    "and macOS, and on Debian or Ubuntu the packages libblas3 and liblapack3"
)
NO_RECORDS = "the folder of real records is absent"
OTHER = "other reasons"
KINDS = {
    NO_BROWSER: "no browser or node",
    NO_NODE: "no browser or node",
    NO_OPENSEES: "OpenSees or its system libraries",
    NO_RECORDS: "real records",
}


def counts(reasons: Iterable[str]) -> Counter[str]:
    """Return how many tests skip for each kind of reason."""
    return Counter(_kind(reason) for reason in reasons)


def _kind(reason: str) -> str:
    return next((kind for text, kind in KINDS.items() if text in reason), OTHER)
