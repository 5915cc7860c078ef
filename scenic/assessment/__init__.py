"""The cost of sampling a program: what analysis removes, how many candidates pass, which requirement costs most."""
