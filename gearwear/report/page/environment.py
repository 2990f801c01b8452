"""How templates become pages: everything escaped that is not marked as safe, and nothing left out silently."""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined


def environment(*folders: Path) -> Environment:
    """Templates of these folders and, behind them, of this one: blocks, and the style of all pages."""
    return Environment(
        loader=FileSystemLoader([*folders, Path(__file__).parent]), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
