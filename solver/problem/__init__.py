"""Question and answer: targets, options and problem, checked; plan, approach and reason."""
