"""``python -m scenic``: the command line of one interpreter, whatever is on the path."""

from scenic.cli.main import main

if __name__ == "__main__":
    main()
