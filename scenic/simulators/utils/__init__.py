"""Parts that world models of several simulators share."""
