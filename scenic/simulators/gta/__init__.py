"""Names of the world of Grand Theft Auto V, for sampling only: no simulator is behind them."""
