"""Faults of the real nodes: what each does, which message must report it, and whether the estimates recover."""
