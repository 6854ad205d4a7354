"""Where the methods break: maps of parameters against step, and random samples of all ranges."""
