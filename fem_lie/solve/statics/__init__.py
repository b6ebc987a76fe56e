"""Static equilibrium: load steps, load paths, steady rotation."""
