"""The `msd` command: one file a subcommand."""
