"""Sets of constraints behind one protocol: a file for each, with its tables and its memory."""
