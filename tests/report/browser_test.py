#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""The report as headless Chromium shows it: on a light screen, on a dark one, and on paper.

    browser_test.py REPORT_PAGES

REPORT_PAGES is the program that writes the sample pages. Ends with 77 when Chromium is missing.
"""
import html
import json
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
BROWSER = next(filter(None, map(shutil.which, BROWSERS)), None)
PAGES = None  # folder with the sample pages
WIDTH, HEIGHT = 1100, 1700
A4_WIDTH = 695  # what its margins leave of 210 mm, in CSS pixels


def browse(page, *arguments, dark=False, width=WIDTH):
    """Opens a page with no way to the network; returns what the browser prints."""
    with tempfile.TemporaryDirectory() as profile:
        return subprocess.run(
            [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
             "--disable-background-networking", "--disable-component-update", "--disable-sync",
             "--disable-dev-shm-usage", "--hide-scrollbars",
             "--host-resolver-rules=MAP * ~NOTFOUND", "--enable-logging=stderr",
             f"--blink-settings=preferredColorScheme={0 if dark else 1}",
             f"--user-data-dir={profile}", f"--window-size={width},{HEIGHT}", *arguments,
             page.as_uri()],
            capture_output=True, timeout=240, check=True)


def pixels(png):
    """Rows of RGB of a PNG as the browser writes it: 8 bits, RGB or RGBA, not interlaced."""
    data, at, body = png.read_bytes(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", data[at + 8:at + 18])
        elif kind == b"IDAT":
            body += data[at + 8:at + 8 + size]
        at += 12 + size
    assert depth == 8 and colour in (2, 6), (depth, colour)
    step = 3 if colour == 2 else 4
    raw, stride = zlib.decompress(body), width * step
    rows, before = [], bytearray(stride)
    for y in range(height):
        kind = raw[y * (stride + 1)]
        row = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left = row[x - step] if x >= step else 0
            up = before[x]
            corner = before[x - step] if x >= step else 0
            if kind == 1:
                row[x] = (row[x] + left) & 255
            elif kind == 2:
                row[x] = (row[x] + up) & 255
            elif kind == 3:
                row[x] = (row[x] + (left + up) // 2) & 255
            elif kind == 4:
                guess = left + up - corner
                _, _, nearest = min((abs(guess - left), 0, left), (abs(guess - up), 1, up),
                                    (abs(guess - corner), 2, corner))
                row[x] = (row[x] + nearest) & 255
        rows.append(row)
        before = row
    return [[tuple(row[x:x + 3]) for x in range(0, stride, step)] for row in rows]


def colours(png):
    count = {}
    for row in pixels(png):
        for pixel in row:
            count[pixel] = count.get(pixel, 0) + 1
    return count


def luminance(rgb):
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4
              for c in (v / 255 for v in rgb)]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(a, b):
    high, low = sorted((luminance(a), luminance(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def variables(style, selector):
    """Colours that a part of the style sheet gives."""
    block = style[style.index(selector):]
    block = block[:block.index("}")]
    return {name: tuple(bytes.fromhex(text if len(text) == 6 else "".join(c * 2 for c in text)))
            for name, text in re.findall(r"--(\w+):#([0-9a-f]{6}|[0-9a-f]{3})\b", block)}


# What is measured of a page: how wide it is, its smallest text in a picture, and what sticks out.
PROBE = """<script>addEventListener("load", () => {
  const edge = document.documentElement.clientWidth;
  const texts = [...document.querySelectorAll("svg text")];
  const out = [...document.querySelectorAll("main *:not(svg *)")].filter(
    e => e.getBoundingClientRect().right > edge + 1 && !e.closest(".scroll"));
  const over = [];
  for (const svg of document.querySelectorAll("main svg")) {
    const boxes = [...svg.querySelectorAll("text")].filter(t => t.textContent.trim())
      .map(t => [t.textContent.trim(), t.getBoundingClientRect()]);
    boxes.forEach(([a, p], i) => boxes.slice(i + 1).forEach(([b, q]) => {
      // The box of a text is higher than its letters; side by side they may not touch.
      if (p.left < q.right && q.left < p.right
          && Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top) > 0.4 * p.height)
        over.push(`${a} | ${b} in: ${svg.getAttribute("aria-label").slice(0, 60)}`);
    }));
  }
  document.body.setAttribute("data-probe", JSON.stringify({
    over,
    edge, width: document.documentElement.scrollWidth,
    text: Math.min(...texts.map(t => parseFloat(getComputedStyle(t).fontSize)
                                     * t.getScreenCTM().a)),
    out: out.map(e => e.outerHTML.slice(0, 80))}));
})</script>"""


def probed(path, folder, width, on_paper=False):
    """The page with a script that its own policy would refuse, as a browser of this width lays it
    out, or as it does for paper so wide."""
    text = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', PROBE, path.read_text())
    if on_paper:
        text = text.replace("@media screen and", "@media speech and").replace(
            "@media print", "@media screen")
    copy = pathlib.Path(folder, "probed.html")
    copy.write_text(text)
    dom = browse(copy, "--dump-dom", width=width).stdout.decode()
    return json.loads(html.unescape(re.search(r'data-probe="([^"]*)"', dom).group(1)))


def blank_below(png):
    """Share of a page's height below the last row that holds anything."""
    rows = pixels(png)
    used = [y for y, row in enumerate(rows) if any(min(pixel) < 250 for pixel in row)]
    return 1.0 - (used[-1] + 1) / len(rows) if used else 1.0


class Report(unittest.TestCase):
    def page(self, name):
        return PAGES / f"{name}.html", json.loads((PAGES / f"{name}.json").read_text())

    def test_renders_whole_and_quietly(self):
        for name in ("effects", "clean", "no-reference", "short"):
            with self.subTest(name):
                path, diagnosis = self.page(name)
                text = path.read_text()
                run = browse(path, "--dump-dom")
                dom = run.stdout.decode()
                self.assertNotIn(b"CONSOLE", run.stderr)
                self.assertEqual(dom.count("<svg"), text.count("<svg"))
                self.assertEqual(dom.count("</svg>"), text.count("</svg>"))
                self.assertGreaterEqual(dom.count('role="img"'), 1)
                for i, finding in enumerate(diagnosis["findings"], 1):
                    self.assertIn(f'id="finding-{i}" data-cause="{finding["cause"]}"', dom)
                self.assertEqual(set(re.findall(r'href="#([^"]+)"', dom))
                                 - set(re.findall(r' id="([^"]+)"', dom)), set())
                self.assertIn('id="verdict"', dom)

    def test_ids_are_unique(self):
        for name in ("effects", "short"):
            ids = re.findall(r' id="([^"]+)"', self.page(name)[0].read_text())
            self.assertEqual(len(ids), len(set(ids)))

    def test_asks_for_nothing_else(self):
        path, _ = self.page("effects")
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder, "net.json")
            browse(path, f"--log-net-log={log}", "--dump-dom")
            urls = re.findall(r'"url":"([a-z-]+:[^"]*)"', log.read_text())
        # What the browser itself asks for on its start is not the page's doing.
        own = ("google.com", "gvt1.com", "googleapis.com", "gstatic.com")
        foreign = {u for u in urls if u.startswith(("http", "ftp", "ws"))
                   and not any(host in u for host in own)}
        self.assertEqual(foreign, set())

    def shot(self, folder, dark):
        png = pathlib.Path(folder, f"{dark}.png")
        browse(self.page("effects")[0], f"--screenshot={png}", dark=dark)
        return colours(png)

    def test_light_and_dark_are_both_legible(self):
        style = self.page("effects")[0].read_text()
        light = variables(style, ":root{--paper")
        dark = variables(style, "prefers-color-scheme:dark){:root{")
        with tempfile.TemporaryDirectory() as folder:
            for wanted, other, is_dark in ((light, dark, False), (dark, light, True)):
                seen = self.shot(folder, is_dark)
                total = sum(seen.values())
                self.assertGreater(seen.get(wanted["paper"], 0), 0.5 * total)
                self.assertLess(seen.get(other["paper"], 0), 0.02 * total)
                # Each colour of the drawings is there, and stands out of the paper.
                for name in ("ink", "muted", "before", "after", "floor"):
                    self.assertGreater(seen.get(wanted[name], 0), 20, (name, is_dark))
                    self.assertGreater(contrast(wanted[name], wanted["paper"]), 4.0, name)

    def test_prints_on_a4_in_light_colours(self):
        path, _ = self.page("effects")
        with tempfile.TemporaryDirectory() as folder:
            pdf = pathlib.Path(folder, "page.pdf")
            browse(path, f"--print-to-pdf={pdf}", "--no-pdf-header-footer", dark=True)
            data = pdf.read_bytes()
        boxes = re.findall(rb"/MediaBox \[0 0 ([\d.]+) ([\d.]+)\]", data)
        self.assertTrue(2 <= len(boxes) <= 12, len(boxes))
        for width, height in boxes:
            self.assertAlmostEqual(float(width), 595.3, delta=1.0)
            self.assertAlmostEqual(float(height), 841.9, delta=1.0)
        drawn = b""
        for stream in re.findall(rb"stream\r?\n(.*?)endstream", data, re.S):
            try:
                drawn += zlib.decompress(stream)
            except zlib.error:
                pass
        style = path.read_text()
        light = variables(style, ":root{--paper")
        dark = variables(style, "prefers-color-scheme:dark){:root{")
        used = {tuple(round(255 * float(v)) for v in rgb) for rgb in
                re.findall(rb"([\d.]+) ([\d.]+) ([\d.]+) rg\b", drawn, re.I)}
        self.assertIn(light["ink"], used)
        self.assertIn(light["before"], used)
        self.assertNotIn(dark["ink"], used)
        self.assertNotIn(dark["paper"], used)

    def test_fits_a_phone(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("effects", "no-reference"):
                with self.subTest(name):
                    seen = probed(self.page(name)[0], folder, 390)
                    self.assertLessEqual(seen["width"], seen["edge"])
                    self.assertEqual(seen["out"], [])
                    self.assertGreaterEqual(seen["text"], 9.0)

    def test_text_of_pictures_is_legible_on_a_screen(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("effects", "no-reference"):
                self.assertGreaterEqual(probed(self.page(name)[0], folder, 1100)["text"], 10.0, name)

    def test_no_words_of_a_picture_overlap(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("effects", "clean", "no-reference", "short"):
                for width, on_paper in ((1280, False), (500, False), (A4_WIDTH, True)):
                    with self.subTest(name, width=width):
                        self.assertEqual(
                            probed(self.page(name)[0], folder, width, on_paper)["over"], [])

    @unittest.skipIf(shutil.which("pdftoppm") is None, "no pdftoppm here (Debian: poppler-utils)")
    def test_no_printed_page_is_half_blank(self):
        for name in ("effects", "no-reference"):
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                pdf = pathlib.Path(folder, "page.pdf")
                browse(self.page(name)[0], f"--print-to-pdf={pdf}", "--no-pdf-header-footer")
                subprocess.run(["pdftoppm", "-r", "20", "-png", pdf, pathlib.Path(folder, "p")],
                               check=True)
                sheets = sorted(pathlib.Path(folder).glob("p-*.png"))
                self.assertGreater(len(sheets), 2)
                for sheet in sheets[:-1]:
                    self.assertLess(blank_below(sheet), 0.4, sheet.name)


if __name__ == "__main__":
    if BROWSER is None:
        print("skipped: no Chromium here (Debian: package chromium)")
        sys.exit(77)
    program = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as pages:
        PAGES = pathlib.Path(pages)
        subprocess.run([program, pages], check=True)
        unittest.main(verbosity=2)
