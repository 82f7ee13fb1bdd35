"""Arms without a closed form: postures by Newton's method from many starts."""
