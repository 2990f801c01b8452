"""Typed results as the keys of the JSON files; the only place of µm and degrees."""
