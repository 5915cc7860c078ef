if not visible altitude from lambda p = Range: minimum distance from p | p to Range: pass
