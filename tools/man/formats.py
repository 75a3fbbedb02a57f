#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""formats.py DOCS FOLDER DATE VERSION: section 5, the file formats, from the pages that define
them."""
import pathlib
import re
import sys

import roff

# page: the Markdown file, the one section of it (None: all), one line
PAGES = {
    "ada4571-capture": ("recordings.md", None, "captures of an angle sensor, as text and as SigMF"),
    "ada4571-model": ("model-file.md", None, "models and calibrations of an angle sensor"),
    "ada4571-config": ("acquisition.md", "Stored configurations",
                       "how the device of an angle sensor is opened"),
}


def main(docs, folder, date, version):
    for name, (source, section, description) in PAGES.items():
        text = (pathlib.Path(docs) / source).read_text(encoding="utf-8")
        page = roff.Page(name, 5, description, date, version)
        page.heading("DESCRIPTION")
        if section:
            text = re.search(rf"^## {re.escape(section)}\n(.*?)(?=^## |\Z)", text, re.M | re.S)[1]
        else:
            text = text.split("\n", 1)[1]  # the title
        roff.markdown(page, text)
        page.see_also([("iio-angle", 1), ("libada4571", 3)] + [(other, 5) for other in PAGES])
        page.write(pathlib.Path(folder))


if __name__ == "__main__":
    main(*sys.argv[1:])
