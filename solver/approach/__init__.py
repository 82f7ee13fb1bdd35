"""One approach about the branch, from its task to the optimum or the reason there is none."""
