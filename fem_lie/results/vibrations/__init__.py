"""Results of linear analyses about an equilibrium: modes, responses, Campbell diagrams."""
