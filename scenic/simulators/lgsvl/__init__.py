"""LGSVL, which is discontinued: its world model, so that programs for it can be sampled."""
