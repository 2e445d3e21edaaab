"""The live view's node: the graph on one side, the page on the other. Begin with ``node``."""
