"""In front of every route: tokens, origins, sizes, times, rates, and the log of requests."""
