"""``python -m gearwear.models``: the nominal solids as STEP files."""

from gearwear.commands.models import main

if __name__ == "__main__":
    raise SystemExit(main())
