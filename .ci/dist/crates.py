"""The licences of all crates that are linked into the program or the Python module, to standard output: each text once, with the
crates that it is of. Wants `cargo metadata` of the workspace on standard input. Which licences are accepted is .deny.toml's matter.
crates.py STANDARD_TEXTS: the folder with the texts of licences, for crates that come without one.
"""

import json
import re
import sys
from pathlib import Path

LINE = "=" * 78
# What is linked: from these crates on, along what is neither for building nor for tests.
ROOTS = ("touchline", "touchline-python")
TEXT = re.compile(r"(licen[cs]e|copying|notice|unlicense|ofl|ufl|copyright)", re.IGNORECASE)


def linked(metadata: dict) -> list[dict]:
    """The crates of others that are linked, by name and version. Macros run in the compiler and are left out with their own."""
    packages = {package["id"]: package for package in metadata["packages"]}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    todo = [identity for identity in nodes if packages[identity]["name"] in ROOTS]
    seen = set(todo)
    while todo:
        for dependency in nodes[todo.pop()]["deps"]:
            identity = dependency["pkg"]
            is_linked = any(kind["kind"] is None for kind in dependency["dep_kinds"])
            is_macro = any("proc-macro" in target["kind"] for target in packages[identity]["targets"])
            if is_linked and not is_macro and identity not in seen:
                seen.add(identity)
                todo.append(identity)
    others = (packages[identity] for identity in seen if packages[identity]["source"])
    return sorted(others, key=lambda package: (package["name"], package["version"]))


def texts(package: dict, standard: Path) -> list[str]:
    """The texts that a crate comes with, else those of the licences that it names."""
    folder = Path(package["manifest_path"]).parent
    files = {path for path in folder.rglob("*") if path.is_file() and TEXT.match(path.name)}
    if package["license_file"]:
        files.add(folder / package["license_file"])
    files = {path for path in files if path.suffix.lower() not in (".rs", ".html", ".json", ".toml", ".py")}
    if files:
        return [path.read_text(encoding="utf-8", errors="replace").strip() for path in sorted(files)]
    names = re.findall(r"[A-Za-z0-9.-]+", (package["license"] or "").replace("/", " "))
    known = [standard / f"{name}.txt" for name in names if (standard / f"{name}.txt").is_file()]
    if not known:
        sys.exit(f"{package['name']} {package['version']}: neither a licence in the crate nor a known one: {package['license']}")
    holders = ", ".join(package["authors"]) or f"the authors of {package['name']}"
    return [f"Copyright: {holders}\n\n{path.read_text(encoding='utf-8').strip()}" for path in known]


def main(standard: str) -> None:
    uses: dict[str, list[str]] = {}
    shown: dict[str, str] = {}
    for package in linked(json.load(sys.stdin)):
        name = f"{package['name']} {package['version']}: {package['license'] or 'as below'}"
        for text in texts(package, Path(standard)):
            # Two copies that break their lines at other places are one text.
            key = " ".join(text.split())
            shown.setdefault(key, text)
            users = uses.setdefault(key, [])
            if name not in users:
                users.append(name)
    for key, users in uses.items():
        print(LINE, *users, "", shown[key], "", sep="\n")


main(*sys.argv[1:])
