"""ANCF elements: beams and plates with positions and all three position gradients."""
