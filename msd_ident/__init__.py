"""Turn a force input and an encoder signal into a model a lab can trust."""
