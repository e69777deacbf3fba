"""From a fibre curve to the parameters of the lay-down models."""
