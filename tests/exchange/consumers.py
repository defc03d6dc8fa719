"""Every consumer's reader in an environment of its own: what it brings is all there is to read with.

usage: consumers.py FOLDER [TOUCHLINE]

Environments are made in FOLDER, or used again where they are; versions are those of requirements.txt. Without a program
nothing is read.
"""

import itertools
import os
import subprocess
import sys
import venv

HERE = os.path.dirname(os.path.abspath(__file__))
# What the exports are compared by everywhere.
COMMON = ["numpy", "opencv-python-headless"]
# Packages, and the formats that are read with them.
CONSUMERS = {
    "opencv": ([], ["soccernet", "wc14", "tsworldcup", "broadtrack", "opencv", "fifa", "json", "imports", "jac"]),
    "pandas": (["pandas"], ["csv"]),
    "pyyaml": (["PyYAML"], ["yolo-pose"]),
    "pycocotools": (["pycocotools"], ["coco"]),
    "pycolmap": (["pycolmap"], ["colmap"]),
    "usd": (["usd-core"], ["usda"]),
    "tracking": (["jsonschema", "scipy"], ["opentrackio", "freed", "chan"]),
    "calib3d": (["scipy", "calib3d"], ["deepsport"]),
    "cdf": (["common-data-format-validator"], ["cdf"]),
}
# It asks for OpenCV with a window; the one without is here.
WITHOUT_DEPENDENCIES = {"calib3d"}


def install(environment, packages, *options):
    if packages:
        pip = [os.path.join(environment, "bin", "pip"), "install", "--quiet", "--disable-pip-version-check"]
        pins = ["--constraint", os.path.join(HERE, "requirements.txt")]
        subprocess.run([*pip, *pins, *options, *packages], check=True)


def make(environment, packages):
    """Makes an environment, unless one with these packages was made completely before."""
    with open(os.path.join(HERE, "requirements.txt"), encoding="utf-8") as pins:
        wanted = f"{sys.version}\n{COMMON + packages}\n{pins.read()}"
    made = os.path.join(environment, "made")
    if os.path.exists(made):
        with open(made, encoding="utf-8") as text:
            if text.read() == wanted:
                return
    venv.create(environment, with_pip=True)
    install(environment, COMMON + [package for package in packages if package not in WITHOUT_DEPENDENCIES])
    install(environment, [package for package in packages if package in WITHOUT_DEPENDENCIES], "--no-deps")
    with open(made, "w", encoding="utf-8") as text:
        text.write(wanted)


def main():
    folder, *programs = sys.argv[1:]
    environments = {name: os.path.join(folder, name) for name in CONSUMERS}
    for name, (packages, _) in CONSUMERS.items():
        make(environments[name], packages)
    failed = []
    for program, (name, (_, formats)) in itertools.product(programs, CONSUMERS.items()):
        python = os.path.join(environments[name], "bin", "python")
        if subprocess.run([python, os.path.join(HERE, "readers.py"), program, *formats], check=False).returncode != 0:
            failed.append(name)
    sys.exit("failed in the environments of: " + ", ".join(failed) if failed else 0)


if __name__ == "__main__":
    main()
