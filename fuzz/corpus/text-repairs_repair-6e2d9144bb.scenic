ego = new Object,
    at position or Range
