"""Real rigs, measured by others: what is true about each, and what the diagnosis says."""
