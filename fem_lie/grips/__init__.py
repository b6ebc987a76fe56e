"""What joints and loads hold on to: frames with a Jacobian, one file for each kind."""
