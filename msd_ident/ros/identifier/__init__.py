"""The identifier node: from live topics or bags to estimates and diagnoses. Begin with ``node``."""
