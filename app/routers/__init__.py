"""HTTP routes, a file a resource: they read a request, ask a service, form the answer."""
