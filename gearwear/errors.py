"""The one error a user is meant to read."""

from __future__ import annotations


class InputError(ValueError):
    """An input or an argument is wrong.

    The message is one line that names the file, line or value, says what is wrong and what
    would be right. The front doors print it and exit with status 2.
    """
