# Rows times columns of a parking lot give 60 places.
rows, columns = DiscreteRange(1, 60), DiscreteRange(1, 60)
require rows * columns == 60
require rows < columns
param layout = [rows, columns]
