"""What demos are compared with: closed forms, equations solved otherwise, tables."""
