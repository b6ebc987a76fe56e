"""What happens in a run: events and their actions, limits of coordinates, sensors, controllers."""
