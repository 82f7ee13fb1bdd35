"""What the routes and the command line do, whoever asks and however it is answered."""
