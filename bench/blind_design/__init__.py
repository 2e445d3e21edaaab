"""The blind study of designed experiments: rigs by lot, one step, then what the tool asks for."""
