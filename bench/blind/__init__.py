"""The blind study: random rigs with hidden effects, and how often the diagnosis names exactly these."""
