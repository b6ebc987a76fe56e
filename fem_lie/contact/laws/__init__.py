"""Contact laws `Penalty` and `Impact`, and the contact forces of a penalty."""
