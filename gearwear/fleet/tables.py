"""Tables of a fleet: the Parquet file of a scan, all of them read together, and results as CSV and Parquet."""

from __future__ import annotations

import csv
import io
import math
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from datetime import date, datetime
from pathlib import Path
from typing import Any

from gearwear.errors import InputError
from gearwear.fleet.manifest import ManifestRow
from gearwear.fleet.quantities import quantities

READ = {
    "key": "VARCHAR", "gear_id": "VARCHAR", "inspected": "TIMESTAMP", "cycles_run": "DOUBLE", "operator": "VARCHAR", "repeat": "VARCHAR",
    "converged": "BOOLEAN", "quantity": "VARCHAR", "tooth": "INTEGER", "flank": "VARCHAR", "value": "DOUBLE", "std": "DOUBLE",
    "low": "DOUBLE", "high": "DOUBLE",
}  # fmt: skip
"""What is read of the table of a scan, and of what type."""
LARGEST = 1e15
"""No number of a gear comes near; squares of what is far larger have no number."""


def needs(package: str) -> InputError:
    """What to say where a package of the extra is missing."""
    return InputError(f"a fleet needs the package {package}: pip install 'gearwear[batch]' would be right")


def rows_parquet(key: str, row: ManifestRow, report: Mapping[str, Any]) -> bytes:
    """The numbers of a scan as a Parquet file, a row each, with the columns of the manifest beside them.

    Parameters
    ----------
    key : str
    row : ManifestRow
        Its further columns are text.
    report : mapping
        As `report.json`.
    """
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        raise needs("pyarrow") from None

    rows = quantities(report)
    number = len(rows)
    text, real = pa.string(), pa.float64()
    columns = {
        "key": pa.array([key] * number, text),
        "gear_id": pa.array([row.gear_id] * number, text),
        "inspected": pa.array([row.inspected] * number, pa.timestamp("s")),
        "cycles_run": pa.array([row.cycles_run] * number, real),
        "operator": pa.array([row.operator] * number, text),
        "repeat": pa.array([row.repeat] * number, text),
        "part": pa.array([report["design"]["part"]] * number, text),
        "converged": pa.array([bool(report["registration"]["converged"])] * number, pa.bool_()),
        "quantity": pa.array([quantity.name for quantity in rows], text),
        "scope": pa.array([quantity.scope for quantity in rows], text),
        "tooth": pa.array([quantity.tooth for quantity in rows], pa.int32()),
        "flank": pa.array([quantity.flank for quantity in rows], text),
        **{
            name: pa.array([_known(getattr(quantity, name)) for quantity in rows], real)
            for name in ("value", "std", "low", "high")
        },
        **{name: pa.array([value] * number, text) for name, value in row.more},
    }
    stream = io.BytesIO()
    pq.write_table(pa.table(columns), stream, compression="zstd")
    return stream.getvalue()


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None


def read_tables(files: Sequence[Path], scope: str) -> list[dict[str, Any]]:
    """Rows of one scope from the tables of many scans.

    Parameters
    ----------
    files : sequence of Path
        Parquet files as `rows_parquet` makes them.
    scope : {"gear", "tooth", "pattern", "mark", "doubt"}

    Returns
    -------
    list of dict
        One per row: the columns that all tables have; None where there is no number.

    Raises
    ------
    InputError
        If one is damaged or no such table.
    """
    if not files:
        return []
    try:
        import duckdb
    except ImportError:
        raise needs("duckdb") from None

    taken = ", ".join(f"CAST({name} AS {kind}) AS {name}" for name, kind in READ.items())
    query = f"SELECT {taken} FROM read_parquet(?, union_by_name = true) WHERE scope = ? ORDER BY ALL"
    with duckdb.connect() as database:
        try:
            rows = _rows(database, query, files, scope)
        except (duckdb.Error, ValueError, OverflowError):
            raise _damaged(database, query, files, scope) from None
    return [dict(zip(READ, row, strict=True)) for row in rows]


def _rows(database: Any, query: str, files: Sequence[Path], scope: str) -> list[tuple[Any, ...]]:
    """OverflowError or ValueError where there are values that nothing can be worked out with, or a date that no Python object has."""
    rows: list[tuple[Any, ...]] = database.execute(query, [[str(file) for file in files], scope]).fetchall()
    if any(isinstance(value, float) and not abs(value) <= LARGEST for row in rows for value in row):
        raise OverflowError
    return rows


def _damaged(database: Any, query: str, files: Sequence[Path], scope: str) -> InputError:
    """Names the first of the tables with which those before it cannot be read."""

    def fails(number: int) -> bool:
        try:
            _rows(database, query, files[:number], scope)
        except Exception:
            return True
        return False

    file = files[bisect_left(range(1, len(files)), True, key=fails)]
    return InputError(
        f"{file}: is damaged or no table of a fleet; gearwear batch into the same folder, once {file.stem}.json is deleted, would be right"
    )


def csv_text(rows: Sequence[Mapping[str, Any]], columns: Sequence[str]) -> str:
    """A table as CSV; what is no finite number is left empty."""
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    for row in rows:
        writer.writerow({name: _cell(value) for name, value in row.items()})
    return text.getvalue()


def _cell(value: Any) -> Any:
    if isinstance(value, float):
        return f"{value:.10g}" if math.isfinite(value) else ""
    if isinstance(value, datetime | date):
        return value.isoformat()
    return "" if value is None else value


def parquet_bytes(rows: Sequence[Mapping[str, Any]], kinds: Mapping[str, type]) -> bytes:
    """A table as a Parquet file; `kinds` says what the columns hold: str, float, int, bool or datetime."""
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        raise needs("pyarrow") from None

    types = {str: pa.string(), float: pa.float64(), int: pa.int64(), bool: pa.bool_(), datetime: pa.timestamp("s")}
    columns = {}
    for name, kind in kinds.items():
        values = [row.get(name) for row in rows]
        if kind is float:
            values = [None if value is None else _known(float(value)) for value in values]
        columns[name] = pa.array(values, types[kind])
    stream = io.BytesIO()
    pq.write_table(pa.table(columns), stream, compression="zstd")
    return stream.getvalue()


def write_tables(folder: Path, name: str, rows: Sequence[Mapping[str, Any]], kinds: Mapping[str, type]) -> list[str]:
    """Write a table as CSV and as Parquet; the names of the files."""
    (folder / f"{name}.csv").write_text(csv_text(rows, list(kinds)), encoding="utf-8", newline="")
    (folder / f"{name}.parquet").write_bytes(parquet_bytes(rows, kinds))
    return [f"{name}.csv", f"{name}.parquet"]
