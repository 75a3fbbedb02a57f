#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""build.py --source TREE --build BUILD --out FOLDER: the documentation as a site. Every code block
is run and every picture drawn while it is built, so that neither can be stale; the pictures of
README.md, which lie in the tree, are compared with a report of today. A block that fails, a picture
that is missing or stale, a link that leads nowhere and a place of this machine on a page end it."""
import argparse
import inspect
import os
import pathlib
import re
import shutil
import subprocess
import sys

import blocks
import catalogue
import links
import pictures

# Title and file of the pages of lib/docs, in the order in which data flows.
METHODS = {"acquisition": "Acquisition", "recordings": "Recordings", "effects": "Effects",
           "model-file": "Model file", "simulation": "Simulation", "conversion": "Conversion",
           "calibration": "Calibration", "tracker": "Tracker", "pins": "Pins", "health": "Health",
           "diagnosis": "Diagnosis", "studies": "Studies"}
HOWTO = {"converter": "Choose a converter", "temperature": "Calibrate over temperature",
         "event-loop": "Read from an event loop", "real-time": "From a real-time thread",
         "python": "From Python", "board": "Install on a board", "overlay": "Write an overlay",
         "study": "Study a production run", "bug": "Report a bug"}
EXPLANATION = {"diagnosis": "How the diagnosis decides", "testing": "How it was tested"}


class Tree:
    """Where things are: the sources, and what was built from them."""

    def __init__(self, source, build):
        self.source, self.build = source, build
        self.program = build / "tools" / "iio-angle"
        self.facts = build / "tools" / "site" / "catalogue_facts"
        self.library, self.python = build / "lib", build / "lib" / "python"
        self.header = source / "lib" / "include"
        self.manual = build / "tools" / "man" / "pages"
        self.interpreter = sys.executable


def with_linked_files(tree, page, text, site):
    """What a page links to outside lib/docs goes along, below tree/."""
    docs = tree.source / "lib" / "docs"

    def carry(match):
        target = (page.parent / match[1]).resolve()
        if target.is_relative_to(docs) or not target.is_file():
            return match[0]
        copy = site / "tree" / target.relative_to(tree.source)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(target, copy)
        return f"]({os.path.relpath(copy, (site / page.relative_to(docs)).parent)})"
    return re.sub(r"\]\(([^):#]+)\)", carry, text)


def run_pages(tree, site, scratch):
    """The pages of lib/docs, with what their blocks say and draw."""
    docs = tree.source / "lib" / "docs"
    for path in sorted(docs.rglob("*.md")):
        name = path.relative_to(docs)
        if name.name == "physics.md":
            continue
        print(f"page {name}", flush=True)
        work = scratch / name.with_suffix("")
        text = with_linked_files(tree, path, path.read_text(encoding="utf-8"), site)
        target = site / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(blocks.run_page(blocks.Runner(tree, work, name), text), encoding="utf-8")
        for result in [*work.glob("*.svg"), *work.glob("report.html")]:
            shutil.copy(result, target.parent)


def manual_pages(tree, site):
    """Sections 1, 3 and 5 as HTML, and a page that lists them; links of functions are left out."""
    folder = site / "reference" / "manual"
    folder.mkdir(parents=True)
    rows = ["# Manual pages", ""]
    for page in sorted(tree.manual.glob("man*/*")):
        if page.is_symlink():
            continue
        done = subprocess.run(["mandoc", "-T", "html", "-O", "style=../../mandoc.css", page], check=True,
                              capture_output=True, text=True)
        (folder / f"{page.name}.html").write_text(done.stdout, encoding="utf-8")
        rows.append(f"- [{page.stem}({page.suffix[1:]})](manual/{page.name}.html)")
    (site / "mandoc.css").write_text("body{max-width:50em;margin:auto;font-family:sans-serif}"
                                     "pre{background:#f4f4f4;padding:.5em;overflow:auto}"
                                     "table.head,table.foot{width:100%}", encoding="utf-8")
    (site / "reference" / "manual.md").write_text("\n".join(rows) + "\n", encoding="utf-8")


def python_page(tree, site):
    """What the docstrings of the package say."""
    sys.path.insert(0, str(tree.python))
    os.environ["LD_LIBRARY_PATH"] = str(tree.library)
    import ada4571
    lines = ["# The Python package", "", inspect.getdoc(ada4571), ""]
    for name in ada4571.__all__:
        thing = getattr(ada4571, name)
        if not callable(thing):
            lines += [f"## {name}", "", f"`{thing}`", ""]
            continue
        lines += [f"## {name}", ""]
        if not issubclass(thing, Exception) if inspect.isclass(thing) else True:
            lines += [f"`{name}{inspect.signature(thing)}`", ""]
        lines += [inspect.getdoc(thing), ""]
        if inspect.isclass(thing) and not issubclass(thing, Exception):
            members = [(key, member) for key, member in vars(thing).items()
                       if not key.startswith("_") and getattr(member, "__doc__", None)
                       and not isinstance(member, (str, int, float, tuple))]
            for key, member in members:
                lines += [f"**{key}**: {inspect.getdoc(member)}", ""]
    (site / "reference" / "python.md").write_text("\n".join(lines), encoding="utf-8")


def method_pages(tree, site):
    """A list of the pages that lie in lib/docs itself."""
    names = [path.stem for path in sorted((tree.source / "lib" / "docs").glob("*.md"))]
    others = [name for name in names if name not in {*METHODS, "index", "tutorial", "physics"}]
    rows = ["# File formats and methods", "", "A page a concept, as they lie beside the sources.", ""]
    rows += [f"- [{METHODS.get(name, name.capitalize())}](../{name}.md)" for name in [*METHODS, *others]]
    (site / "reference" / "pages.md").write_text("\n".join(rows) + "\n", encoding="utf-8")


def navigation(effects):
    """mkdocs.yml; JSON is YAML, so lists need no library."""
    import json
    nav = [{"Home": "index.md"}, {"Tutorial": "tutorial.md"},
           {"How to": [{title: f"howto/{name}.md"} for name, title in HOWTO.items()]},
           {"Catalogue": [{"Overview": "catalogue/index.md"}] +
            [{name: f"catalogue/{name}.md"} for name in effects]},
           {"Explanation": [{title: f"explanation/{name}.md"} for name, title in EXPLANATION.items()]},
           {"Reference": [{"C API": "reference/c.md"}, {"Python": "reference/python.md"},
                          {"Manual pages": "reference/manual.md"},
                          {"Formats and methods": "reference/pages.md"}]}]
    return json.dumps({"site_name": "libada4571", "docs_dir": "pages", "site_dir": "site",
                       "use_directory_urls": False, "plugins": ["search"], "nav": nav,
                       "theme": {"name": "mkdocs", "highlightjs": False, "nav_style": "dark"}},
                      indent=1)


def for_doxygen(header):
    """The header's plain comments, each marked for what stands below it or to its left."""
    text = re.sub(r"^/\*(?! -{9})", "/**", header, flags=re.M).replace("/** ", "/** @file\n * ", 1)
    return re.sub(r"^( .*?[;,0-9][ ]*)/\*(?!\*)", r"\1/**<", text, flags=re.M)


def doxygen(tree, scratch, target):
    """The C API."""
    text = (tree.header / "ada4571.h").read_text(encoding="utf-8")
    source = scratch / "ada4571.h"
    source.write_text(for_doxygen(text), encoding="utf-8")
    settings = {"PROJECT_NAME": "libada4571", "INPUT": source, "STRIP_FROM_PATH": scratch,
                "OUTPUT_DIRECTORY": scratch, "HTML_OUTPUT": target, "GENERATE_LATEX": "NO",
                "EXTRACT_ALL": "YES", "QUIET": "YES", "OPTIMIZE_OUTPUT_FOR_C": "YES",
                "MACRO_EXPANSION": "YES", "PREDEFINED": "ADA4571_API=", "WARN_IF_UNDOCUMENTED": "NO",
                "AUTOLINK_SUPPORT": "YES", "JAVADOC_AUTOBRIEF": "YES", "WARN_AS_ERROR": "YES",
                "VERBATIM_HEADERS": "NO", "HTML_DYNAMIC_MENUS": "NO",
                "HAVE_DOT": "NO", "SEARCHENGINE": "NO", "HTML_TIMESTAMP": "NO"}
    lines = "\n".join(f"{key} = {value}" for key, value in settings.items())
    subprocess.run(["doxygen", "-"], input=lines, text=True, check=True)
    page = (target / "ada4571_8h.html").read_text(encoding="utf-8")
    functions = set(re.findall(r"^ADA4571_API[^(]*?(\w+)\(", text, flags=re.M))
    missing = sorted(name for name in functions if f">{name}<" not in page)
    if missing or not functions:
        sys.exit(f"functions that the C API's page leaves out: {missing or 'all'}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("source", "build", "out"):
        parser.add_argument(f"--{name}", type=lambda text: pathlib.Path(text).resolve(), required=True)
    given = parser.parse_args()
    tree, out = Tree(given.source, given.build), given.out
    shutil.rmtree(out, ignore_errors=True)
    pages, scratch = out / "pages", out / "scratch"
    (pages / "reference").mkdir(parents=True)
    try:
        run_pages(tree, pages, scratch)
    except blocks.BlockFailed as failure:
        sys.exit(str(failure))
    print("catalogue", flush=True)
    effects = catalogue.build(tree, pages / "catalogue", scratch / "catalogue")
    stale = pictures.stale(tree, scratch / "pictures")
    if stale:
        sys.exit(f"{', '.join(stale)} in lib/docs/pictures: not what a report shows; draw them anew with "
                 f"tools/site/pictures.py --source . --build {os.path.relpath(tree.build, tree.source)}")
    manual_pages(tree, pages)
    python_page(tree, pages)
    method_pages(tree, pages)
    doxygen(tree, scratch, pages / "reference" / "c-api")
    (out / "mkdocs.yml").write_text(navigation(effects), encoding="utf-8")
    subprocess.run([sys.executable, "-m", "mkdocs", "build", "--quiet", "--strict", "--config-file",
                    out / "mkdocs.yml"], check=True)
    (out / "site" / "404.html").unlink()  # for servers; its links begin at the root of one
    found = [f"{path.relative_to(out / 'site')}: {link}"
             for path, link in links.broken(out / "site")]
    if found:
        sys.exit("links that lead nowhere:\n" + "\n".join(found))
    here = [path for path in sorted((out / "site").rglob("*.html"))
            if str(out) in path.read_text("utf-8", "replace")]
    if here:
        sys.exit(f"pages that show {out}: {', '.join(str(path.relative_to(out)) for path in here)}")
    shutil.rmtree(scratch)
    print(f"{out / 'site' / 'index.html'}")


if __name__ == "__main__":
    main()
