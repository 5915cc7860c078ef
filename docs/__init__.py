"""The documentation: pages in Markdown, and in `_extensions` the programs that build and test them."""
