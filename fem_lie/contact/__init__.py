"""Contact: two surfaces and the law between them."""
