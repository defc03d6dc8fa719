"""`python -m touchline`: the program of the same name, with the same arguments."""

import os
import shutil
import subprocess
import sys
import sysconfig
from typing import Optional

NAME = "touchline.exe" if os.name == "nt" else "touchline"


def program() -> Optional[str]:
    """Where the program is: $TOUCHLINE, else where pip puts scripts, else on the path."""
    schemes = [sysconfig.get_path("scripts"), os.path.dirname(sys.executable)]
    user = os.path.join(os.path.expanduser("~"), ".local", "bin")
    found = [os.environ.get("TOUCHLINE", "")] + [os.path.join(folder, NAME) for folder in [*schemes, user]]
    existing = (path for path in found if os.path.isfile(path) and os.access(path, os.X_OK))
    return next(existing, shutil.which(NAME))


def main() -> int:
    path = program()
    if path is None:
        print(
            "touchline: the program is not installed beside this Python module; install the wheel, or set TOUCHLINE to its path",
            file=sys.stderr,
        )
        return 2
    arguments = [path, *sys.argv[1:]]
    if os.name == "nt":
        return subprocess.call(arguments)
    os.execv(path, arguments)


if __name__ == "__main__":
    sys.exit(main())
