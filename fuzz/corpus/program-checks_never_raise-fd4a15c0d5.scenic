behavior B(** p: Range): self
