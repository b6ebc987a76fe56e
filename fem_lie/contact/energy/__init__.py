"""Energy of contacts by penalty: their law as numbers, and its balance over a run."""
