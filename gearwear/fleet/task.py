"""One scan: read, compared, and turned into what the store keeps. This is what a worker runs."""

from __future__ import annotations

import gc
import json
import traceback
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gearwear.errors import InputError, NotEnoughMemory
from gearwear.fleet.keys import Digests, Options, contents_of
from gearwear.fleet.manifest import ManifestRow
from gearwear.fleet.outcome import Outcome, State
from gearwear.memory import GB, allowing


@dataclass(frozen=True, slots=True)
class Job:
    """A scan that is to be compared.

    Parameters
    ----------
    key : str
    row : ManifestRow
    folder : str
        That the manifest's relative paths are meant from; absolute.
    contents : tuple of str
        Digests of the files, as the key has them.
    options : Options
    memory : float
        Bytes that it may take.
    """

    key: str
    row: ManifestRow
    folder: str
    contents: tuple[str, ...]
    options: Options
    memory: float


def run(job: Job) -> Outcome:
    """Compare a scan with its design; whatever is wrong with it becomes its outcome and nobody else's."""
    try:
        with allowing(job.memory / GB):
            return _compared(job)
    except NotEnoughMemory as error:
        return Outcome(job.key, State.FAILED, why=str(error))
    except InputError as error:
        return _refused(job, error)
    except MemoryError:
        return Outcome(job.key, State.FAILED, why="the memory of the machine is not enough")
    except Exception:
        return Outcome(job.key, State.FAILED, why=traceback.format_exc())
    finally:
        gc.collect()  # the commands switch the collector off, and a batch is long


def _compared(job: Job) -> Outcome:
    from gearwear.comparison.stations import compare
    from gearwear.design.files.toml import read_design
    from gearwear.fleet.tables import rows_parquet
    from gearwear.report.files.writing import json_text
    from gearwear.report.records.comparison import document
    from gearwear.wear_law.study import Ahead

    row, folder = job.row, Path(job.folder)
    now = contents_of(row, folder, Digests())
    if now != list(job.contents):
        changed = next(name for name, was, is_ in zip(row.files, job.contents, now, strict=True) if was != is_)
        raise RuntimeError(f"{changed}: is not the same here and now as when the batch began")
    results = compare(
        read_design(folder / row.design),
        [folder / name for name in row.scans],
        row.part,
        [folder / name for name in row.before],
        row.units,
        job.options.loop,
        ahead=Ahead(row.cycles_run) if row.cycles_run else None,
    )
    report = as_in_manifest(document(results, [f"{job.key}.json", f"{job.key}.parquet"]), row)
    plain = json.loads(json_text(report))
    return Outcome(job.key, State.DONE, json_text(report).encode(), rows_parquet(job.key, row, plain))


def _refused(job: Job, error: InputError) -> Outcome:
    """Bad input; but what the driver could read and this worker cannot is no fault of the input."""
    now = contents_of(job.row, Path(job.folder), Digests())
    if now != list(job.contents):
        return Outcome(job.key, State.FAILED, why=f"{error} (the files could be read when the batch began)")
    return Outcome(job.key, State.REFUSED, why=f"line {job.row.line}: {error}")


def as_in_manifest(report: Mapping[str, Any], row: ManifestRow) -> dict[str, Any]:
    """The report with its files named as the manifest names them, so that it does not depend on where the fleet lies."""
    scan = {**report["scan"], "file": row.scans[0], "files": list(row.scans), "before_files": list(row.before)}
    return {**report, "design": {**report["design"], "source": row.design}, "scan": scan}
