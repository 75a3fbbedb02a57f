#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""pictures.py --source TREE --build BUILD: draws the pictures of a report that README.md shows, with
headless Chromium, into lib/docs/pictures.

They lie in the tree, because README.md is read where nothing is built. So each carries what it shows,
as the text of its page and a digest of the page's style, and building the site compares that with a
report of today: words must be the same, numbers within a hundredth or their last digit. That needs no
browser, and no machine's fonts."""
import argparse
import hashlib
import html
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

EFFECTS = ["stray-field:b=0.01,direction_deg=40", "amplitude-mismatch:k=0.012", "offset-temperature-drift",
           "channel-skew:dt_s=4e-6"]
# Name, and where in the report it begins and ends.
PARTS = {"report-budget.png": ('<header id="verdict">', '<section class="finding" id="finding-1"'),
         "report-cause.png": ('<section class="finding" id="finding-4"', "<h2 "),
         "report-record.png": ('<h2 id="record">', "<h2>")}
WIDTH = 1200
KEYWORD = b"Description"
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
BROWSERS = ("chromium", "chromium-browser", "google-chrome")


def report(program, folder):
    """The report of a sensor with four faults."""
    folder.mkdir(parents=True, exist_ok=True)
    options = [part for effect in EFFECTS for part in ("--effect", effect)]
    subprocess.run([program, "simulate", "--seed", "3", "--temperature", "ramp:from=10,to=60", *options,
                    "-o", folder / "four.csv"], check=True)
    subprocess.run([program, "diagnose", "--report", folder / "four.html", folder / "four.csv"], check=True,
                   stdout=subprocess.DEVNULL)
    return (folder / "four.html").read_text(encoding="utf-8")


def part_of(page, name):
    """What a picture shows of the report."""
    begin, end = PARTS[name]
    if begin not in page:
        raise ValueError(f"{name}: the report has no {begin}")
    start = page.index(begin)
    return page[start:page.index(end, start + len(begin))]


def words_of(page, name):
    """The text of a part and, of its plots, what stands for them and their titles: not the numbers at the
    axes, which gnuplot chooses. And the page's style."""
    part = part_of(page, name)
    spoken = []
    for plot in re.findall(r"<svg.*?</svg>", part, flags=re.S):
        spoken += re.findall(r'aria-label="([^"]*)"', plot)
        texts = re.findall(r"<text.*?</text>", plot, flags=re.S)
        spoken += [text for text in (re.sub(r"<[^>]*>", "", text).strip() for text in texts)
                   if re.search(r"[^\W\d_]{2}", text)]
    plain = re.sub(r"<[^>]*>", " ", re.sub(r"<svg.*?</svg>", " ", part, flags=re.S))
    style = "".join(re.findall(r"<style>(.*?)</style>", page, flags=re.S))
    return " ".join([*html.unescape(" ".join([plain, *spoken])).split(),
                     hashlib.sha256(style.encode()).hexdigest()[:12]])


def same(shown, now):
    """Whether the words are the same and the numbers nearly."""
    def numbers(text):
        """With one and a half of the last digit of each that has a point."""
        found = NUMBER.findall(text.rpartition(" ")[0])
        return [(float(number), 1.5 * 10.0 ** -len(number.partition(".")[2]) if "." in number else 0.0)
                for number in found]

    def words(text):
        text, _, style = text.rpartition(" ")
        return NUMBER.sub("#", text), style
    return words(shown) == words(now) and all(abs(a - b) <= max(0.01 * abs(a), digit)
                                              for (a, digit), (b, _) in zip(numbers(shown), numbers(now)))


def chunks(png):
    """(kind, data) of a PNG."""
    at = 8
    while at < len(png):
        size, kind = struct.unpack(">I4s", png[at:at + 8])
        yield kind, png[at + 8:at + 8 + size]
        at += 12 + size


def with_words(png, words):
    """The PNG with what it shows, and without other texts."""
    out = png[:8]
    for kind, data in chunks(png):
        if kind == b"IDAT" and words is not None:
            text = KEYWORD + b"\0\1\0\0\0" + zlib.compress(words.encode())
            out += chunk(b"iTXt", text)
            words = None
        if kind not in (b"tEXt", b"zTXt", b"iTXt"):
            out += chunk(kind, data)
    return out


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def shown_by(png):
    """What a PNG says that it shows; nothing where it does not."""
    for kind, data in chunks(png):
        if kind == b"iTXt" and data.startswith(KEYWORD + b"\0\1\0\0\0"):
            return zlib.decompress(data[len(KEYWORD) + 5:]).decode()
    return ""


def stale(tree, scratch):
    """The pictures that show another report than that of today."""
    page = report(tree.program, scratch)
    folder = tree.source / "lib" / "docs" / "pictures"
    found = [name for name in PARTS if not (folder / name).is_file()
             or not same(shown_by((folder / name).read_bytes()), words_of(page, name))]
    return found + sorted(path.name for path in folder.iterdir() if path.name not in PARTS)


def browse(page, *arguments):
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if not browser:
        sys.exit("Chromium is missing")
    with tempfile.TemporaryDirectory() as profile:
        return subprocess.run(
            [browser, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
             "--disable-background-networking", "--disable-dev-shm-usage", "--hide-scrollbars",
             "--host-resolver-rules=MAP * ~NOTFOUND", "--blink-settings=preferredColorScheme=1",
             f"--user-data-dir={profile}", *arguments, page.as_uri()],
            check=True, capture_output=True, text=True, timeout=240).stdout


def draw(page, name, folder):
    """A part of the report as Chromium shows it, as high as it is."""
    head = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", page[:page.index("<main>")])
    alone, picture = folder / "alone.html", folder / name
    tight = "<style>main{padding:8px 24px 12px!important}" \
            "main>:first-child{margin-top:0!important}</style>"
    measure = "<script>document.title = document.querySelector('main').offsetHeight</script>"
    alone.write_text(f"{head}{tight}<main>{part_of(page, name)}</main>{measure}</body></html>",
                     encoding="utf-8")
    shown = browse(alone, f"--window-size={WIDTH},800", "--dump-dom")
    height = re.search(r"<title>(\d+)</title>", shown)[1]
    browse(alone, f"--window-size={WIDTH},{height}", f"--screenshot={picture}")
    return with_words(picture.read_bytes(), words_of(page, name))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    for name in ("source", "build"):
        parser.add_argument(f"--{name}", type=lambda text: pathlib.Path(text).resolve(), required=True)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        page = report(given.build / "tools" / "iio-angle", pathlib.Path(scratch))
        for name in PARTS:
            target = given.source / "lib" / "docs" / "pictures" / name
            target.write_bytes(draw(page, name, pathlib.Path(scratch)))
            print(target)


if __name__ == "__main__":
    main()
