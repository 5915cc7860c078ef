"""Statistics of runs that hold or fail, on plain numbers: intervals, tests, comparisons, weights, splitting."""
