"""What the artist can do; each operator is one undo step."""
