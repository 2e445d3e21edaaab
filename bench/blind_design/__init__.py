"""The blind study of designed experiments: random rigs, one force step, then ``investigate``."""
