"""Elements of thin shells without transverse shear, and their pressure and coupling."""
