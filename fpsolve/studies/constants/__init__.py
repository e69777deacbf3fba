"""Constants of a potential that several studies need."""
