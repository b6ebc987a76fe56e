"""Results of linear analyses about an equilibrium: modes of vibration, frequency responses."""
