"""Whether laid webs are as even as their prediction says.

`web_homogeneity` puts the variation of simulated webs beside that of `predict_web`, in
standard errors. The names are loaded from their modules.
"""
