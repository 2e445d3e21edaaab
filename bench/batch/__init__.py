"""Many records: speed, overhead, scaling, memory, faults and an object store, measured with the real thing."""
