"""Programs made from the grammar, and the properties that the compiler must have on them."""
