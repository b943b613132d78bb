"""Old names: refused with the new one, and stated alike by code, changelog and support."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

import thermobearing as tb
from thermobearing.border.arguments import checked
from thermobearing.border.errors import InputError
from thermobearing.border.keywords import renamed
from thermobearing.border.library import data_path
from thermobearing.border.toml import read_toml
from thermobearing.cli import app
from thermobearing.results.writing import as_attribute

ROOT = Path(__file__).parents[2]
NAMES = read_toml(data_path("renamed.toml"))["names"]
OPTIONS = {
    "--overwrite": "cyclic",
    "--compare-with": "validate",
    "--write-sidecars": "intake",
    "--start-from": "identify",
    "--codes": "bridge",
    "--kind": "motions make",
    "--record": "motions make",
}
KEYWORDS = ("overwrite", "test", "keep", "progress", "start_from")


@pytest.mark.parametrize("row", NAMES, ids=lambda row: f"{row['old']} to {row['new']}")
def test_the_changelog_lists_each_old_name(row: dict[str, str]) -> None:
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    section = re.split(r"^## ", text, flags=re.MULTILINE)
    versions = [part for part in section if part.startswith((row["version"], "Unreleased"))]
    version = versions[-1]  # a version that is not released yet is the first one
    names = version.split("**Names**")[1].split("\n**")[0]
    for name in (row["old"], row["new"]):
        assert re.search(rf"[`(. ]{re.escape(name)}(?![\w-])|{re.escape(name)}=", names)


def test_the_support_states_no_other_rule() -> None:
    """Old names are refused from the version that replaces them, as the changelog has it."""
    text = (ROOT / "SUPPORT.md").read_text(encoding="utf-8")
    assert "not accepted" in text
    assert "with a warning" not in text


@pytest.mark.parametrize("row", [row for row in NAMES if row["old"].startswith("--")])
def test_commands_refuse_an_old_option_with_the_new_one(row: dict[str, str]) -> None:
    done = CliRunner().invoke(app, [*OPTIONS[row["new"]].split(), row["old"]])
    assert done.exit_code == 2
    assert row["new"] in done.output


@pytest.mark.parametrize("row", [row for row in NAMES if row["new"] in KEYWORDS])
def test_functions_refuse_an_old_keyword_with_the_new_one(row: dict[str, str]) -> None:
    @checked
    def _save(
        *, overwrite: int = 0, test: int = 0, keep: int = 0, progress: int = 0, start_from: int = 0
    ) -> None: ...

    with pytest.raises(InputError) as refused:
        _save(**{row["old"]: 1})
    assert f'"{row["new"]}"' in str(refused.value)
    assert row["version"] in str(refused.value)


def test_every_old_name_is_refused_where_it_was() -> None:
    """Each row is an option, a keyword, or one of the names below."""
    tested = {*OPTIONS, *KEYWORDS, "inspect_files", "predict", "outside"}
    assert {row["new"] for row in NAMES} == tested
    with pytest.raises(AttributeError) as refused:
        _ = tb.take_in  # type: ignore[attr-defined]
    assert '"inspect_files"' in str(refused.value)
    with pytest.raises(InputError) as refused_keyword:
        tb.forecast(None, ambients=[0.0])  # type: ignore[call-arg, arg-type]
    assert '"predict"' in str(refused_keyword.value)


def test_a_result_with_an_old_column_is_refused_with_the_new_one() -> None:
    test = tb.cyclic_test(strain=[0.5], cycles=1)
    result = tb.run("shen-hdr-specimen", test)
    rows = [{**row, "passed": row["outside"]} for row in result.tested_range.to_dict("records")]
    old = [{key: value for key, value in row.items() if key != "outside"} for row in rows]
    attributes = {"tested_range": as_attribute(old)}
    with pytest.raises(InputError) as refused:
        _ = type(result)(result.dataset.assign_attrs(attributes)).tested_range
    assert '"outside"' in str(refused.value)


def test_factors_is_the_command_lambda() -> None:
    options = [
        set(re.findall(r"--[a-z-]+", CliRunner().invoke(app, [word, "--help"]).output))
        for word in ("lambda", "factors")
    ]
    assert options[0] == options[1]
    assert "--reference-temperature" in options[1]


@pytest.mark.parametrize(
    ("words", "form"),
    [
        (["cyclic", "--scheme", "published"], "--model-option scheme=VALUE"),
        (["serve", "shen-hdr-bridge", "--lead-ends", "half-space"], "--model-option lead_ends="),
        (["hybrid", "--force-noise", "0.5"], "--laboratory force_noise=VALUE"),
    ],
)
def test_commands_refuse_an_option_that_became_an_entry(words: list[str], form: str) -> None:
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 2
    assert form in done.output


@pytest.mark.parametrize(
    ("words", "pieces"),
    [
        ("shceme=published", ['unknown key "shceme"', '"scheme"?']),
        ("scheme", ["scheme=VALUE"]),
        ("side=3", ["side.film=VALUE"]),
        ("scheme.film=3", ["scheme=VALUE"]),
        ("side.flm=3", ["side", '"film"?']),
        ("stack=half stack=full", ["each key once"]),
    ],
)
def test_faults_of_an_entry_name_its_key(words: str, pieces: list[str]) -> None:
    options = [word for option in words.split() for word in ("--model-option", option)]
    done = CliRunner().invoke(app, ["cyclic", *options])
    assert done.exit_code == 2
    for piece in pieces:
        assert piece in done.output


def test_the_new_name_is_stated_only_where_it_is_known() -> None:
    assert renamed("force", ["axial_force"]) == ""
    with pytest.raises(InputError) as refused:
        tb.run("shen-hdr-specimen", history=tb.cyclic_test(strain=1))  # type: ignore[call-arg]
    assert '"test"' in str(refused.value)
