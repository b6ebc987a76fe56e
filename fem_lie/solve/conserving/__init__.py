"""Energy- and momentum-conserving schemes, with optional numerical dissipation."""
