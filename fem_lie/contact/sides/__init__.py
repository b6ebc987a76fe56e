"""Contact geometry: surfaces, detection of near pairs, gaps, contact points, kinematics."""
