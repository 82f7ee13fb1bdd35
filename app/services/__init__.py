"""What the routes and the command line do, without HTTP."""
