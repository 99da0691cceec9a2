"""The licences of all that is linked into the programs and the libraries they carry."""

import json
from collections import defaultdict
from pathlib import Path

import tools

NOTES = tools.ROOT / "licenses"
# A table whose head has its licence, as a comment.
DIRECTIONS = tools.ROOT / "crates/analysis/src/robustness/joe_kuo.txt"
# What licence files are called: how their names begin.
NAMES = tuple((NOTES / "names.txt").read_text().split())
HEAD = """\
Amontons itself is under MIT or Apache-2.0. Its programs, and the libraries that FMUs bring, also contain the crates below
(https://crates.io), Rust's standard library, parts of compilers' run-time libraries and a table of direction numbers, whose
notes come last. A licence's text follows the names of those that come with it.
"""


def third_party(target):
    """One text, in one order."""
    crates = sorted(linked(target))
    names = defaultdict(list)
    for name, folder, terms, authors in crates:
        for text in texts(name, folder, terms, authors):
            names[text].append(name)
    listed = "".join(f"  {name}: {terms}\n" for name, _, terms, _ in crates)
    parts = [f"{', '.join(dict.fromkeys(users))}\n\n{text}\n" for text, users in names.items()]
    parts += [(NOTES / note).read_text() for note in ["RUST.txt", "RUNTIMES.txt"]]
    lines = [line.removeprefix("#").strip() for line in DIRECTIONS.read_text().splitlines() if line.startswith("#")]
    # The last line names the columns.
    parts.append("\n".join(lines[:-1]).strip() + "\n")
    return HEAD + "\n" + listed + "".join(f"\n{'=' * 80}\n{part}" for part in parts)


def linked(target):
    """Name and version, folder, licence, authors of the crates that the programs for a target are linked with."""
    kinds = ["--edges", "normal,no-proc-macro", "--prefix", "none", "--format", "{p}"]
    tree = tools.output(["cargo", "tree", "--locked", "--package", "amontons-cli", "--target", target, *kinds])
    names = {" ".join(line.split()[:2]) for line in tree.splitlines()}
    known = tools.output(["cargo", "metadata", "--locked", "--format-version", "1", "--filter-platform", target])
    for package in json.loads(known)["packages"]:
        name, version = package["name"], package["version"]
        # Packages of this repository have no source.
        if f"{name} v{version}" in names and package["source"]:
            terms = package["license"] or f"see {package['license_file']}"
            yield f"{name} {version}", Path(package["manifest_path"]).parent, terms, package["authors"]


def texts(name, folder, terms, authors):
    """The licence files that a crate brings, or else the text that its licence has for all."""
    # In subfolders too: a font's lies beside the font.
    files = sorted(path for path in folder.rglob("*") if path.name.upper().startswith(NAMES) and path.is_file())
    found = [path.read_text(errors="replace").strip() for path in files]
    if found:
        return found
    if terms != "MIT":
        raise tools.Failed(f"{name}, licensed as {terms}, brings no text of it; {__file__} has to be told one")
    # "sarah <>": who gives no address.
    holders = ", ".join(author.removesuffix(" <>") for author in authors) or f"the authors of {name.split()[0]}"
    permission = (tools.ROOT / "LICENSE-MIT").read_text().partition("Permission is hereby granted")
    says = "The packages name their licence, MIT, and bring no text; this is the standard one."
    return [f"{says}\n\nCopyright (c) {holders}\n\n{''.join(permission[1:]).strip()}"]
