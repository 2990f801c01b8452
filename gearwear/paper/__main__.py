"""``python -m gearwear.paper``."""

import sys

from gearwear.paper.show import main

sys.exit(main())
