"""Contact: two surfaces and the contact law between them."""
