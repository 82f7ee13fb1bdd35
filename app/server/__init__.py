"""The application put together and served: routes, guards, services, their beginning and end."""
