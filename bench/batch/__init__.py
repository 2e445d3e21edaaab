"""Measures ``msd batch``: speed, overhead, scaling, memory, faults, and an object store."""
