"""Programs about regions that move with the sample, each beside another implementation of the language."""
