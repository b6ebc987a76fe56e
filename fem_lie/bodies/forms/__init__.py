"""Bodies whose energy, loads and inertia are forms of the user."""
