"""`python -m app` is the command `prunus`."""

from app.commands.cli import main

if __name__ == "__main__":
    main()
