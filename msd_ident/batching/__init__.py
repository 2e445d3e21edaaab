"""Many records: where they lie, one row for each, on the processes of one machine or of a cluster, into one table."""
