"""Rigs that others measured: what is known about each, and what the diagnosis says."""
