"""The model sets no ego, so that it must be set before it is used."""
model lib.model
new Car left of ego by 3
#               ^^^ SC209
ego = new Car
