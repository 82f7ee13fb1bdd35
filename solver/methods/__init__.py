"""The methods: a file each, and a row each in `solver.methods.registry`."""
