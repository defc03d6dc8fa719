"""What the tests of the Python module share: the program to compare with, and small documents."""

import json
import os
import subprocess

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
DEMO = os.path.join(ROOT, "projects", "demo")
# The program of the same build; .ci/python names it.
PROGRAM = os.environ.get("TOUCHLINE", "")
NO_PROGRAM = "" if PROGRAM else "TOUCHLINE does not name the program to compare with"


def run(*arguments, code=0):
    """Runs the program; returns what it wrote to standard output."""
    ran = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False)
    assert ran.returncode == code, ran.stdout + ran.stderr
    return ran.stdout


def read(path):
    """A JSON file."""
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def largest_difference(one, other, place="document"):
    """The largest difference of any two numbers of two JSON values that must otherwise be equal."""
    is_number = [isinstance(value, (int, float)) and not isinstance(value, bool) for value in (one, other)]
    if all(is_number):
        return abs(one - other) / max(1.0, abs(one))
    assert type(one) is type(other), f"{place}: {one!r} and {other!r}"
    if isinstance(one, dict):
        assert list(one) == list(other), f"{place}: {list(one)} and {list(other)}"
        return max((largest_difference(one[key], other[key], f"{place}.{key}") for key in one), default=0.0)
    if isinstance(one, list):
        assert len(one) == len(other), f"{place}: {len(one)} and {len(other)} entries"
        pairs = enumerate(zip(one, other))
        return max((largest_difference(a, b, f"{place}[{index}]") for index, (a, b) in pairs), default=0.0)
    assert one == other, f"{place}: {one!r} and {other!r}"
    return 0.0

