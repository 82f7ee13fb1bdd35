"""What routes and commands ask for, without HTTP: a room for each thing served."""
