"""Energy and momenta of scenes whose nodes are no frames: rods, nets, thin shells and solids."""
