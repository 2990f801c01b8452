"""Designs and tooth profiles as files: TOML, drawing tables, REXS, NPZ."""
