"""One robot over days: when did a parameter change, how surely, and an alarm whose false-alarm rate is stated."""
