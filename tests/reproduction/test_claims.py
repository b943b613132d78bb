"""Claims, rules, verdicts and flips, on small examples."""

from typing import Any

import numpy as np
import pytest

from reproduction.claims import (
    CLOSE,
    CONTRADICTED,
    ECHOES,
    FAILED,
    HOLDS,
    NEEDS,
    REPRODUCED,
    UNDECIDED,
    Claim,
    Limit,
    NeedsTestData,
    Order,
    Trend,
    Variants,
    Verdict,
    Within,
    find_flip,
    judge,
    judge_motions,
    load_claims,
    make_row,
)
from reproduction.measures import evaluate, functions, words
from reproduction.report import Reproduction
from reproduction.runs import Runs, parameters
from thermobearing.border.errors import InputError

RISES = Trend(direction="rises", along="time")
FALLS = Trend(direction="falls", along="time")
USUALLY_RISES = Trend(direction="rises", along="time", usually=True)
ORDER = Order(names=("a", "b", "c"))


def claim(**changes: Any) -> Claim:
    given = {
        "id": "one",
        "place": "nowhere",
        "statement": "something",
        "computed": "[bearing(n).geometry.first_shape_factor for n in SPECIMENS]",
        "rule": Within(value=(12.0, 12.0), per_cent=1.0),
    }
    return Claim(**given | changes)


@pytest.mark.parametrize(
    ("rule", "numbers", "kind"),
    [
        (Within(value=2.0, per_cent=5.0), 2.09, REPRODUCED),
        (Within(value=2.0, per_cent=5.0), 2.11, CONTRADICTED),
        (Within(value=-2.0, per_cent=5.0), -1.91, REPRODUCED),
        (Within(value=(1.0, 2.0), per_cent=5.0), (1.0, 2.2), CONTRADICTED),
        (Within(value=(1.0, 2.0), per_cent=5.0), (1.0, 2.0, 3.0), FAILED),
        (Within(value=0.0, absolute=0.5, unit="degC"), 0.4, REPRODUCED),
        (Within(value=0.0, absolute=0.5, unit="degC"), 0.6, CONTRADICTED),
        (RISES, (1.0, 2.0, 3.0), HOLDS),
        (RISES, (1.0, 2.0, 2.0), HOLDS),
        (RISES, (1.0, 1.009, 1.018, 1.1), CLOSE),
        (RISES, (1.0, 1.1, 1.08), CONTRADICTED),
        (USUALLY_RISES, (1.0, 2.0, 3.0, 4.0, 3.0), HOLDS),
        (USUALLY_RISES, (1.0, 2.0, 3.0, 2.0), CONTRADICTED),
        (USUALLY_RISES, (1.0, 1.0), CLOSE),
        (FALLS, [(3.0, 2.0), (2.0, 1.0)], HOLDS),
        (FALLS, [(3.0, 2.0), (1.0, 2.0)], CONTRADICTED),
        (RISES, 1.0, FAILED),
        (ORDER, (3.0, 2.0, 1.0), HOLDS),
        (ORDER, (3.0, 1.0, 2.0), CONTRADICTED),
        (ORDER, (3.0, 1.0), FAILED),
        (Limit(above=1.0), (1.1, 1.2), HOLDS),
        (Limit(above=1.0), (1.1, 1.0), HOLDS),
        (Limit(above=1.0), 1.009, CLOSE),
        (Limit(above=1.0), 0.995, CLOSE),
        (Limit(above=1.0, exact=True), 0.995, CONTRADICTED),
        (Limit(above=1.0), (1.1, 0.98), CONTRADICTED),
        (Limit(above=0.0), -1e-9, CONTRADICTED),
        (Limit(above=1.0, below=2.0), 2.5, CONTRADICTED),
        (Limit(above=1.0), np.nan, FAILED),
        (Limit(above=1.0), (), FAILED),
        (NeedsTestData(why="its records"), (), NEEDS),
    ],
)
def test_a_rule_gives_its_verdict(rule: Any, numbers: Any, kind: str) -> None:
    verdict = judge(rule, numbers)
    assert verdict.kind == kind
    assert verdict.words.startswith(kind)
    assert verdict.settled == (kind in (REPRODUCED, HOLDS))


def test_a_motion_that_turns_a_verdict_decides_it_both_ways() -> None:
    """Each row is computed on every stand-in of its spectrum, and only if it asks for a motion."""
    yes, no, close = Verdict(HOLDS, "yes"), Verdict(CONTRADICTED, "no"), Verdict(CLOSE, "close")
    assert judge_motions(yes, [yes, no]).kind == UNDECIDED
    assert judge_motions(no, [no, yes]).kind == UNDECIDED
    assert judge_motions(yes, [close]).kind == UNDECIDED
    assert judge_motions(yes, [Verdict(FAILED, "failed"), yes]) == yes
    assert Runs(stand_in=1).motion("jra-ii-i-3") == "jra-ii-i-1"
    assert Runs(stand_in=2).motion("jra-ii-i-3") == "jra-ii-i-2"
    runs = Runs()
    assert runs.cyclic("shen-hdr-specimen", 23.0)
    assert not runs.shaken
    for _ in range(2):  # made, then kept
        runs.shaken = False
        assert runs.bridge("shen-bilinear-bridge", "jra-ii-i-1", 23.0, duration=0.1)
        assert runs.shaken
    other = runs.varied(moved_on=1)
    moved = other.bridge("shen-bilinear-bridge", "jra-ii-i-1", 23.0, duration=0.1)
    assert list(moved.table["motion"]) == ["jra-ii-i-2"]
    assert runs.varied(moved_on=1) is other


def test_rows_that_echo_an_input_are_marked_and_groups_counted_apart() -> None:
    same = make_row(claim(echoes=True), Runs()).verdict
    assert same.kind == ECHOES
    assert same.settled
    wrong = claim(echoes=True, rule=Within(value=1.0, per_cent=1.0))
    assert make_row(wrong, Runs()).verdict.kind == CONTRADICTED
    rows = [make_row(one, Runs()) for one in load_claims("misprints")[:2]]
    result = Reproduction(None, [*rows, make_row(claim(echoes=True), Runs())])
    assert {group: sum(counts.values()) for group, counts in result.groups.items()} == {
        "statements": 1,
        "misprints": 2,
    }
    assert result.groups["statements"][ECHOES] == 1
    assert result.headline.startswith("Reproduction: 1 statements, 1 echoes an input; 2 misprints")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"rule": {"kind": "within", "value": 1.0}}, "per_cent or absolute"),
        ({"rule": {"kind": "limit"}}, "above, below or both"),
        ({"rule": {"kind": "needs-test-data", "why": "x"}}, "give computed, or"),
        ({"computed": None}, "give computed, or"),
    ],
)
def test_a_claim_that_cannot_be_judged_is_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        claim(**changes)


def test_every_claim_has_its_expression_and_its_parameters() -> None:
    claims = load_claims()
    assert len({one.id for one in claims}) == len(claims)
    for one in claims:
        assert one.computed or one.rule.kind == "needs-test-data"
        assert set(one.flips) <= set(parameters())
    with pytest.raises(InputError, match="chapter-3"):
        load_claims("chapter3")


def test_functions_of_expressions_say_what_they_return() -> None:
    assert {"bearing", "cycles", "shaken", "cell_4_16", "hybrid"} <= set(functions())
    assert all(
        (function.__doc__ or "").startswith(("Return", "Run")) for function in functions().values()
    )
    assert evaluate('bearing(HDR).geometry.rubber_layers + number("u_B")', words(Runs())) == 184.0


def test_changes_reach_every_bearing_and_structure() -> None:
    runs = Runs({"K_r": 1.1, "m_1": 2.0, "sigma_Y": 0.5})
    plain = Runs()
    for name in ("shen-hdr-specimen", "shen-lhdr-bridge"):
        before, after = plain.bearing(name), runs.bearing(name)
        ratio = after.hysteresis.layer_stiffness / before.hysteresis.layer_stiffness
        assert ratio == pytest.approx(1.1)
        assert (before.lead is None) == (after.lead is None)
    lead = runs.bearing("shen-lhdr-specimen").lead
    assert lead is not None
    assert lead.yield_stress == 6.0  # MPa
    masses = [one.structure("hybrid-pier").masses[0].mass for one in (plain, runs)]
    assert masses[1] == pytest.approx(2.0 * masses[0])
    assert Runs({"a_g": 1.2}).motion("jra-i-i-1")["factor"] == 1.2
    rocking = Runs({"k_theta3": 10.0}).structure("hybrid-pier")  # it has no such spring
    assert rocking == plain.structure("hybrid-pier")
    assert plain.motion("jra-i-i-1") == "jra-i-i-1"
    with pytest.raises(InputError, match=r'no parameter "sigma_y".*sigma_Y'):
        Runs({"sigma_y": 1.0})


def test_a_simulation_is_made_once() -> None:
    runs = Runs()
    test = runs.cyclic("shen-hdr-specimen", 23.0)
    assert runs.cyclic("shen-hdr-specimen", 23.0) is test
    assert runs.cyclic("shen-hdr-specimen", 0.0) is not test


@pytest.mark.parametrize(
    ("limits", "change"),
    [((0.0, 1.1), 0.1), ((0.0, 1.3), 0.3), ((0.0, 1.6), None), ((0.9, 1.4), -0.1)],
)
def test_the_smallest_change_that_flips(limits: tuple[float, float], change: float | None) -> None:
    def judged(runs: Runs) -> Verdict:
        return judge(Limit(above=limits[0], below=limits[1]), runs.change.get("K_r", 1.0))

    result = find_flip(claim(), judged, Variants(), "K_r").change
    assert result is None if change is None else result == pytest.approx(change, abs=0.02)


def test_a_row_says_what_flips_it_or_why_more_stiffness_does_not() -> None:
    row = make_row(claim(flips=("t_r",), depends="geometry"), Runs(), Variants())
    assert (row.verdict.kind, row.stiffer) == (REPRODUCED, True)
    assert row.smallest is not None
    assert abs(row.smallest.change or 0.0) == pytest.approx(0.01, abs=0.005)
    assert make_row(claim(flips=("t_r",)), Runs(), Variants()).verdict.kind == FAILED


def test_a_broken_row_is_a_row_with_its_reason() -> None:
    missing = make_row(claim(computed="no_such_thing(HDR)"), Runs())
    assert missing.verdict.kind == FAILED
    assert "no_such_thing" in missing.verdict.words
    few = make_row(claim(rule=Within(value=(1.0, 2.0, 3.0), per_cent=1.0)), Runs())
    assert few.verdict.words == "failed: 2 numbers, 3 printed"
    unknown = make_row(claim(rule=NeedsTestData(why="its records"), computed=None), Runs())
    assert unknown.verdict.kind == NEEDS
