"""In front of every route: who may ask, how much, how long, and what is logged of it."""
