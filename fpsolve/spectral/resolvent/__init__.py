"""The resolvent of the generator: spectra of what a fibre lays down."""
