"""Sets of constraints behind one interface: one file, table and history for each type."""
