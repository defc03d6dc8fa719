"""One software bill of materials (CycloneDX) of the program and the Python module, from those that cargo-cyclonedx writes of
each, and of what is linked beside crates: bill.py PROGRAM.json MODULE.json "NAME VERSION LICENCE"..., to standard output.
"""

import json
import sys
from pathlib import Path


def other(words: str) -> dict:
    """A component that is no crate."""
    name, version, licence = words.split(" ", 2)
    reference = f"pkg:generic/{name}@{version}"
    return {
        "type": "library",
        "bom-ref": reference,
        "name": name,
        "version": version,
        "licenses": [{"expression": licence}],
        "purl": reference,
    }


def main(program: str, module: str, *others: str) -> None:
    # The project's own crates are named by their folders, which are others on another machine.
    here = Path.cwd().as_uri()
    texts = (Path(path).read_text(encoding="utf-8").replace(here, "file:///touchline") for path in (program, module))
    bill, second = (json.loads(text) for text in texts)
    # A number and a time of its own would make two builds of one version differ.
    bill.pop("serialNumber", None)
    bill["metadata"].pop("timestamp", None)
    beside = [other(words) for words in others]
    components = {part["bom-ref"]: part for part in [*second["components"], *bill["components"], *beside]}
    bill["components"] = [components[reference] for reference in sorted(components)]
    dependencies = {one["ref"]: one for one in [*second["dependencies"], *bill["dependencies"]]}
    bill["dependencies"] = [dependencies[reference] for reference in sorted(dependencies)]
    json.dump(bill, sys.stdout, indent=2)
    print()


main(*sys.argv[1:])
