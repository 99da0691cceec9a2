"""The licences of all that is linked into the programs and the libraries they carry."""

import json
import re
from collections import defaultdict
from pathlib import Path

import tools

FILE = re.compile(r"(licen[cs]e|copying|unlicense|notice|ofl)([-._].*)?", re.IGNORECASE)
HEAD = """\
Amontons itself is under MIT or Apache-2.0. Its programs, and the libraries that FMUs bring, also contain Rust's standard
library (MIT or Apache-2.0, https://www.rust-lang.org) and the crates below. A licence's text follows the names of those
that come with it.
"""


def third_party(target):
    """One text, in one order."""
    crates = {name: (Path(path).parent, terms) for name, path, terms in linked(target)}
    names = defaultdict(list)
    for name, (folder, _) in sorted(crates.items()):
        for file in sorted(path for path in folder.iterdir() if FILE.fullmatch(path.name) and path.is_file()):
            names[file.read_text(errors="replace").strip()].append(name)
    listed = "".join(f"  {name}: {terms}\n" for name, (_, terms) in sorted(crates.items()))
    texts = [f"\n{'=' * 80}\n{', '.join(dict.fromkeys(users))}\n\n{text}\n" for text, users in names.items()]
    return HEAD + "\n" + listed + "".join(texts)


def linked(target):
    """Name and version, manifest, licence of the crates that the programs for a target are linked with."""
    kinds = ["--edges", "normal,no-proc-macro", "--prefix", "none", "--format", "{p}"]
    tree = tools.output(["cargo", "tree", "--locked", "--target", target, *kinds])
    names = {" ".join(line.split()[:2]) for line in tree.splitlines()}
    known = tools.output(["cargo", "metadata", "--locked", "--format-version", "1", "--filter-platform", target])
    for package in json.loads(known)["packages"]:
        name, version = package["name"], package["version"]
        if f"{name} v{version}" in names and name != "amontons":
            terms = package["license"] or f"see {package['license_file']}"
            yield f"{name} {version}", package["manifest_path"], terms
