"""In front of every route: tokens and scopes (a row a route), origins, sizes, times, rates, logs."""
