"""Methods side by side on the same targets: scenarios, how they are run, what is told of them."""
