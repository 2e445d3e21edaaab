"""Faults done to the real nodes: what each is, what must be said about it, and that the numbers come back."""
