"""`python -m dh2urdf`, where the command is not on the path."""

from dh2urdf.cli import main

if __name__ == "__main__":
    main()
