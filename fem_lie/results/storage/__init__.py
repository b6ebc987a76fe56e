"""How results lie in a file: rows that are written in place, and checksums of all contents."""
