"""One comparison in a process of its own: the only file here that imports gearwear, of the checkout that PYTHONPATH names.

python compare_one.py OUT.json DESIGN.toml PART|- SCAN [SCAN …]
"""

from __future__ import annotations

import json
import math
import resource
import sys
import time
import traceback
from pathlib import Path
from typing import Any

KEEP = (
    "version",
    "scan",
    "registration",
    "closed_loop",
    "wear",
    "thickness",
    "thinnest",
    "broken",
    "lost_volume_mm3",
    "root",
    "form",
    "notes",
)


def main(out: str, design: str, part: str, *scans: str) -> None:
    begun = time.perf_counter()
    import gearwear
    from gearwear.errors import InputError

    try:
        from gearwear.api import compare
    except ImportError:  # version 0.1.0
        from gearwear.stages import compare  # type: ignore[no-redef]
    line: dict[str, Any] = {"package": str(Path(gearwear.__file__).parent), "version": gearwear.__version__}
    started = time.perf_counter()
    try:
        results = compare(design, list(scans), part=None if part == "-" else part, inspection=False)
        report = _report(results)
        line["found"] = _plain({key: report[key] for key in KEEP if key in report})
    except InputError as refusal:
        line["refused"] = str(refusal)
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        line["failed"] = f"{type(error).__name__}: {error} ({Path(where.filename).name}:{where.lineno})"
    ended, used = time.perf_counter(), resource.getrusage(resource.RUSAGE_SELF)
    line |= {
        "import_seconds": round(started - begun, 3),
        "seconds": round(ended - started, 3),
        "processor_seconds": round(used.ru_utime + used.ru_stime, 3),
        "peak_mb": round(_peak_kb(used.ru_maxrss) / 1024.0, 1),
    }
    Path(out).write_text(json.dumps(line))


def _peak_kb(otherwise: int) -> int:
    """Most memory of this process by itself; `ru_maxrss` may be that of the process it was started from."""
    status = Path("/proc/self/status")
    lines = status.read_text().splitlines() if status.exists() else []
    return next((int(line.split()[1]) for line in lines if line.startswith("VmHWM:")), otherwise)


def _report(results: Any) -> dict[str, Any]:
    if hasattr(results, "to_dict"):
        return dict(results.to_dict())
    from gearwear.report.records.comparison import document

    return dict(document(results, []))


def _plain(value: Any) -> Any:
    """Plain data; what is not finite is None; per-column lists that nothing here reads are left out."""
    if isinstance(value, dict):
        return {str(k): _plain(v) for k, v in value.items() if k not in ("covariance", "changes")}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, bool | str) or value is None:
        return value
    if isinstance(value, int):
        return value
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return str(value)


if __name__ == "__main__":
    main(*sys.argv[1:])
