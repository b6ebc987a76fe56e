"""Studies: tables and sweeps of what the demos show once. Each runs as ``-m studies.NAME``."""
