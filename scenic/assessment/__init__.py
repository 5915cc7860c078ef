"""What a program is like to sample: what analysis removes, how many candidates pass, which requirement costs most."""
