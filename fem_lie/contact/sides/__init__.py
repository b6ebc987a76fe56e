"""What is geometric in contact: surfaces, who is near whom, gaps and where they are felt."""
