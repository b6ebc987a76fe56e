"""Elements from vectors, strains and a law, with their derivatives in forward mode."""
