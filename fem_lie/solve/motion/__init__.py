"""What all schemes in time share."""
