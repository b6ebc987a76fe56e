"""Steps of each body's own size, with multipliers between bodies of different sizes."""
