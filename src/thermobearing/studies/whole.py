"""A study from whatever says it to its result, in one call."""

from pathlib import Path
from typing import Any

from thermobearing.border.errors import InputError
from thermobearing.studies.case import load_study, make_study
from thermobearing.studies.designs import plan
from thermobearing.studies.engine import ExecutorName, Progress, run_study
from thermobearing.studies.files import study_result
from thermobearing.studies.record import Study
from thermobearing.studies.result import StudyResult
from thermobearing.studies.shard import run_shard


def study(
    source: Study | dict[str, Any] | str | Path,
    directory: str | Path | None = None,
    *,
    executor: ExecutorName = "process",
    jobs: int | None = None,
    address: Any = None,
    shard: str | None = None,
    progress: Progress | None = None,
) -> StudyResult:
    """A study of very many runs: plan, runs, and what is drawn from them.

    Parameters
    ----------
    source : a TOML file (docs/files.md), its table, or a Study.
    directory : where it is kept, new or begun with the same study, of which the rest is done; needs
        the extra `study`. None: nothing is written, and all runs are done here one by one.
    executor : "process" or "dask".
    jobs : processes, 1 to 1024; as many as there are cores by default.
    address : of Dask's scheduler, or a `distributed.Client`.
    shard : "i/n": every n-th part only, from the i-th.
    progress : called with (runs done, all runs); with a directory.

    Returns
    -------
    StudyResult

    Raises
    ------
    InputError : everything that is wrong with the study; another one was begun there.
    OutputError : the directory cannot be written.

    Examples
    --------
    >>> factors = {"bearing": "shen-hdr-bridge", "motion": "jra-ii-i-1", "ambient": ["0 degC"]}
    >>> table = {"kind": "study", "name": "p1", "case": {"duration": "2 s"}, "factors": factors}
    >>> study(table).table["outcome"].tolist()
    ['completed']
    """
    made = _made(source)
    if directory is not None:
        run_study(
            made,
            directory,
            executor=executor,
            jobs=jobs,
            address=address,
            shard=shard,
            progress=progress,
        )
        return study_result(directory)
    if executor != "process" or jobs is not None or address is not None or shard is not None:
        raise InputError("executor, jobs, address and shard need a directory", "study()")
    runs = plan(made)
    return StudyResult(run_shard(made, runs), made, {"runs": len(runs)})


def _made(source: Any) -> Study:
    """The study that something stands for."""
    if isinstance(source, Study):
        return source
    if isinstance(source, dict):
        return make_study(source, "study()")
    if isinstance(source, str | Path):
        return load_study(source)
    raise InputError(f"{type(source).__name__}: must be a file, its table, or a Study", "study()")
