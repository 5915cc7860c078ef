"""Extensions of Sphinx for this documentation, and the runner of its code blocks that the tests use."""
