"""Within what limits the numbers of the contact lie, as plain numbers: part of ``report.json``."""

from __future__ import annotations

from gearwear.comparison.results import PairResult
from gearwear.report.records.numbers import Json


def contact_limits_record(pair: PairResult) -> Json:
    """Limits beside the numbers of the contact, and why; nothing where they stand by themselves."""
    limits, path = pair.limits, pair.open_path
    if limits is None or path is None:
        return {}
    ends = (("low", limits.low, path[0]), ("high", limits.high, path[1]))
    record: Json = {"range_from": "; ".join(limits.why)}
    for end, numbers, length in ends:
        record |= {
            f"transmission_error_um_{end}": 1e3 * numbers.transmission_error,
            f"contact_ratio_{end}": numbers.contact_ratio,
            f"path_of_contact_mm_{end}": length,
        }
    return record
