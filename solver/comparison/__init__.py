"""Methods side by side on the same targets: contests, how they are run, what they found."""
