"""What is imported is declared; what is packaged is whole and of one version; one BLAS thread."""

import ast
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from pathspec import GitIgnoreSpec  # of hatchling

import thermobearing
from thermobearing.border.threads import VARIABLES

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
RECIPE = (ROOT / "recipe.yaml").read_text(encoding="utf-8")
# Tools of developers and openseespy, a peer of the tests, may be of any version.
EXTRAS = [
    text
    for extra, some in PROJECT["optional-dependencies"].items()
    for text in some
    if extra != "lint" and not text.startswith(("thermobearing[", "openseespy"))
]


def plain(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def declared(texts: list[str]) -> set[str]:
    return {plain(re.split(r"[<>=!~;\[ ]", text)[0]) for text in texts}


def imported() -> set[str]:
    result = set()
    for path in (ROOT / "src").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                result |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                result.add(node.module.split(".")[0])
    return result - set(sys.stdlib_module_names) - {"thermobearing"}


def test_what_is_imported_is_declared() -> None:
    known = declared([*PROJECT["dependencies"], *EXTRAS])
    owners = packages_distributions()
    missing = {
        name
        for name in imported()
        if not known & {plain(owner) for owner in owners.get(name, [name])}
    }
    assert not missing


def test_the_program_starts_without_any_extra() -> None:
    """Modules of each command, of the live page and of reports import what is required alone."""
    extras = ["jinja2", "openpyxl", "typst", "pyarrow", "emcee", "distributed"]
    code = (
        f"import sys; sys.modules |= dict.fromkeys({extras})\n"
        "import thermobearing.reporting, thermobearing.live.page, thermobearing.commands.study\n"
        "import thermobearing.identify.run, thermobearing.studies.run.engine\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_every_dependency_has_an_upper_bound() -> None:
    open_ended = [
        text for text in [*PROJECT["dependencies"], *EXTRAS] if "<" not in text.split(";")[0]
    ]
    assert open_ended == []


@pytest.mark.parametrize(
    ("name", "pattern"),
    [
        ("CITATION.cff", r"^version: (\S+)"),
        ("recipe.yaml", r'^  version: "(\S+)"'),
        ("CHANGELOG.md", r"^## (\d\S+)"),
    ],
)
def test_every_file_states_the_same_version(name: str, pattern: str) -> None:
    result = re.search(pattern, (ROOT / name).read_text(encoding="utf-8"), re.MULTILINE)
    assert result
    assert result[1] == PROJECT["version"] == thermobearing.__version__


def test_the_recipe_has_the_same_dependencies() -> None:
    names = {"netCDF4": "netcdf4", "matplotlib": "matplotlib-base"}  # of conda-forge
    texts = [*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["jit"]]
    parts = [re.fullmatch(r"([\w.-]+)(.*)", text) for text in texts]
    expected = {f"{names.get(part[1], part[1])} {part[2]}" for part in parts if part}
    run = RECIPE.partition("  run:\n")[2].partition("\ntests:")[0]
    assert set(re.findall(r"- (\w.*)", run)) - {"python >=${{ python_min }}"} == expected
    assert f'python_min: "{PROJECT["requires-python"].removeprefix(">=")}"' in RECIPE


COMMAND = """
import contextlib, sys
from thermobearing.cli import main
sys.argv = ["thermobearing", "motions", "show", "jra-ii-i-1", "-q"]
with contextlib.suppress(SystemExit):
    main()
"""
TESTS = "import conftest\nimport numpy, scipy.linalg\n"
ASK = """
import os
import numpy, scipy.linalg  # if the command has not imported them
tasks = "/proc/self/task"  # only Linux tells how many threads there are
threads = os.listdir(tasks) if os.path.exists(tasks) else ["self"]
names = [open(f"{tasks}/{task}/comm").read() for task in threads if task != "self"] or ["python"]
print(os.environ["OPENBLAS_NUM_THREADS"], sum("jemalloc" not in name for name in names))
"""


def thread_counts(begin: str, **environment: str) -> list[str]:
    clean = {key: value for key, value in os.environ.items() if key not in VARIABLES}
    done = subprocess.run(
        [sys.executable, "-c", "import sys\n" + begin + ASK],
        cwd=ROOT,
        env=clean | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.splitlines()[-1].split()


@pytest.mark.parametrize(
    "begin",
    [
        pytest.param(COMMAND, id="command", marks=pytest.mark.thorough),
        pytest.param(TESTS, id="tests"),
    ],
)
def test_blas_has_one_thread(begin: str) -> None:
    assert thread_counts(begin) == ["1", "1"]


@pytest.mark.thorough
def test_the_environment_may_say_otherwise() -> None:
    assert thread_counts(COMMAND, OPENBLAS_NUM_THREADS="2")[0] == "2"


NEEDED = {"src", "tests", "docs", "Makefile", "conftest.py", "pyproject.toml", "recipe.yaml"}
USE = """
import sys
import thermobearing as tb
assert tb.__file__.startswith(sys.argv[1]), tb.__file__
test = tb.cyclic_test(strain=[0.5], cycles=1, dt=0.1)
print(tb.run("lrb-example", test, ambient=-20).outcome)
print(len(tb.list_motions()), tb.load_structure("pier-p1").name)
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dist")
    command = [sys.executable, "-m", "hatchling", "build", "-d", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.thorough
def test_wheel_works_outside_the_repository(built: Path, tmp_path: Path) -> None:
    (wheel,) = built.glob("*.whl")
    with zipfile.ZipFile(wheel) as packed:
        packed.extractall(tmp_path)
    assert (tmp_path / "thermobearing" / "py.typed").exists()
    assert (tmp_path / "thermobearing" / "__init__.pyi").exists()
    sys_path_first = f"import sys; sys.path.insert(0, sys.argv[1])\n{USE}"
    done = subprocess.run(
        [sys.executable, "-P", "-c", sys_path_first, str(tmp_path)],
        cwd=tmp_path,
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},  # nothing is in the cache for this place
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["completed", "18", "pier-p1"]


def listed_files() -> set[str]:
    """The files under version control; without git, those that .gitignore does not exclude."""
    if shutil.which("git"):
        command = ["git", "ls-files"]
        process = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        return set(process.stdout.splitlines())
    excluded = GitIgnoreSpec.from_lines([*(ROOT / ".gitignore").read_text().splitlines(), ".git"])
    names: set[str] = set()
    for place, folders, files in os.walk(ROOT):
        above = Path(place).relative_to(ROOT)
        folders[:] = [name for name in folders if not excluded.match_file(f"{above / name}/")]
        paths = {(above / name).as_posix() for name in files}
        names |= {path for path in paths if not excluded.match_file(path)}
    return names


def test_sdist_holds_what_is_needed(built: Path) -> None:
    (sdist,) = built.glob("*.tar.gz")
    with tarfile.open(sdist) as packed:
        names = packed.getnames()
    parts = [Path(name).parts for name in names]
    assert {part[1] for part in parts} >= NEEDED
    if (ROOT / ".git").exists():
        assert listed_files() <= {"/".join(part[1:]) for part in parts}
    sources = [part for part in parts if part[1] == "src"]
    assert {Path(*part).suffix for part in sources} == {
        ".py",
        ".pyi",
        ".toml",
        ".npz",
        ".json",
        ".typed",
        ".md",
        *(".css", ".html", ".js", ".typ"),  # of reports
    }
