"""What all nodes share: names, parameters, conversions, queues, shutdown."""
