"""Reading scans: files of points, triangles or sections into clean `Scan`s in mm. The only importer of file readers."""

from gearwear.scan.reading import READERS, read_one, read_scan
from gearwear.scan.types import Scan
from gearwear.scan.units import UNITS, check_size

__all__ = ["READERS", "UNITS", "Scan", "check_size", "read_one", "read_scan"]
