"""In front of every route: tokens, scopes (a row a route), origins, sizes, times, rates, logs."""
