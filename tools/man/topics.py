#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""topics.py HEADER FOLDER DATE VERSION: section 3, a page a section of the header, each function a
link to its page, and libada4571(3) with the conventions that the header begins with."""
import pathlib
import re
import sys

import roff

TOPICS = {
    "status": "how a function says that it failed",
    "frame": "samples and angles",
    "source": "where frames come from: devices, recordings, the simulation",
    "recording": "captures in files",
    "model": "models of a sensor, and the effects that they hold",
    "calibration": "offsets and amplitudes from captures",
    "conversion": "volts in, angles out",
    "tracker": "calibration that follows while the magnet turns",
    "pins": "the sensor's gain control and power down lines",
    "simulation": "the simulated sensor, and the emulator that serves it",
    "diagnosis": "what the simulation gets wrong, and why",
    "health": "is the sensor sound",
    "study": "many captures, many sensors, one answer",
    "figures": "the application note's figures as data",
}


def sections(header):
    """Name and text of the header's sections."""
    parts = re.split(r"^/\* -+ (.+?) \*/$", header.split("#ifdef __cplusplus\n}")[0], flags=re.M)
    return list(zip(parts[1::2], parts[2::2]))


def cut(text):
    """The comments that begin a line, and what stands between them."""
    parts = re.split(r"^(/\*.*?\*/)$", text, flags=re.M | re.S)
    for comment, code in [("", parts[0]), *zip(parts[1::2], parts[2::2])]:
        words = re.sub(r"^ ?\* ?", "", comment.strip("/").strip("*"), flags=re.M)
        # What is continued stands below the parenthesis, also without the macro before it.
        code = re.sub(r"^ {12}(?= )", "", code, flags=re.M)
        code = re.sub(r"\n{2,}", "\n\n", code.replace("ADA4571_API ", "").strip("\n"))
        yield " ".join(words.split()), code


def functions(text):
    names = re.findall(r"\b(ada4571_\w+)\(", re.sub(r"/\*.*?\*/", "", text, flags=re.S))
    return list(dict.fromkeys(name for name in names if name != "ada4571_progress"))


def topic_page(name, text, date, version):
    called = f"ada4571_{name.replace(' ', '_')}"
    page = roff.Page(called, 3, TOPICS.get(name, f"section {name} of libada4571"), date, version,
                     [called] + [f for f in functions(text) if f != called])
    page.heading("LIBRARY")
    page.paragraph("libada4571 (`-lada4571`, `pkg-config --cflags --libs libada4571`)")
    page.heading("SYNOPSIS")
    page.literal("#include <ada4571.h>")
    page.heading("DESCRIPTION")
    for comment, code in cut(text):
        if code:
            page.literal(code)
        if comment:
            page.paragraph(comment)
    return page


def overview(header, names, date, version):
    page = roff.Page("libada4571", 3, "angles from analog sine/cosine angle sensors", date, version)
    page.heading("SYNOPSIS")
    page.literal("#include <ada4571.h>\n\ncc program.c $(pkg-config --cflags --libs libada4571)")
    page.heading("DESCRIPTION")
    page.paragraph("A C library that captures such a sensor through any converter that Linux knows "
                   "(IIO), calibrates it, turns its volts into angles, simulates it, and diagnoses "
                   "what that simulation gets wrong. By topic:")
    for name in names:
        page.tagged(f"\\fBada4571_{roff.escape(name)}\\fR(3)", TOPICS.get(name, name))
    page.heading("CONVENTIONS")
    text = re.search(r"^ \* -+\n(.*?)^ \*/", header, re.M | re.S)[1]
    roff.markdown(page, re.sub(r"\n {3,}", "\n", re.sub(r"^ \* ?", "", text, flags=re.M)))
    return page


def main(header, folder, date, version):
    header = pathlib.Path(header).read_text(encoding="utf-8")
    folder = pathlib.Path(folder)
    found = sections(header)
    pages = [overview(header, [name for name, _ in found], date, version)]
    for name, text in found:
        page = topic_page(name, text, date, version)
        pages.append(page)
        for function in functions(text):
            if function != page.name:
                (folder / "man3").mkdir(parents=True, exist_ok=True)
                link = folder / "man3" / f"{function}.3"
                link.unlink(missing_ok=True)
                link.symlink_to(f"{page.name}.3")
    for page in pages:
        page.see_also([(other.name, 3) for other in pages] + [("iio-angle", 1)])
        page.write(folder)


if __name__ == "__main__":
    main(*sys.argv[1:])
