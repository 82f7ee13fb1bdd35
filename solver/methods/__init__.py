"""The methods: one file each, one row each in `solver.methods.registry`."""
