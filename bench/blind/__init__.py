"""The blind study: rigs by lot, hidden causes, and how often the diagnosis is right about them."""
