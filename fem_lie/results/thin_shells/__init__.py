"""Forces and moments within thin shells."""
