"""What lies between both ends of a step: of nodes that turn, and of cells as discrete gradients."""
