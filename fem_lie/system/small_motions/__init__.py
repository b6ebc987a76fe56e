"""The equations beside a state: small motions about rest and about steady rotation."""
