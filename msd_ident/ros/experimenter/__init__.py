"""The experimenter node: plays profiles on the rig and stops at its limits. Begin with ``node``."""
