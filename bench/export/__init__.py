"""Whether an exported model moves in its target as it does here, and whether a wrong simulation's mistake is named."""
