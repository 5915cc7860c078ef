behavior B():
    (invariant): self
