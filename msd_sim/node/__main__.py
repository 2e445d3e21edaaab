"""``python -m msd_sim.node``: the same as ``ros2 run msd_ident rig``."""

import sys

from msd_sim.node import main

sys.exit(main())
