"""``python -m gearwear.compare``, the main job."""

from gearwear.commands.compare import main

if __name__ == "__main__":
    raise SystemExit(main())
