"""What the routes and the command line do, whoever asks: a room for each thing served."""
