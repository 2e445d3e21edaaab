"""The replayer node: a bag back to the graph. Begin with ``node``."""
