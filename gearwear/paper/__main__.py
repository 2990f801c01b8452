"""``python -m gearwear.paper``."""

from gearwear.commands.paper import main

if __name__ == "__main__":
    raise SystemExit(main())
