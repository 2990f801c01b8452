"""``python -m gearwear``: the same as the console command."""

from gearwear.cli import main

if __name__ == "__main__":
    raise SystemExit(main())
