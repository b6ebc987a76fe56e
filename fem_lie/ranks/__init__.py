"""Several ranks that all run the same script: who writes, factors they share, and how they end."""
