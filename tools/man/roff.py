# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Manual pages in man(7): the few macros that ours need, and Markdown, as our pages use it, in
them."""
import re
import textwrap

WIDTH = 78


def escape(text):
    """Text as it stands, with nothing left that roff would act on."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "".join(c if ord(c) < 128 else f"\\[u{ord(c):04X}]" for c in text)


def prose(text):
    """One paragraph of Markdown: `code` and **strong** in bold, *emphasis* in italics."""
    def literal(match):
        return "\0B" + match[1].replace(" ", "\1") + "\0R"
    text = re.sub(r"`([^`]+)`", literal, text)
    text = re.sub(r"\[([^]]+)\]\((https?:[^)]+)\)", r"\1 (\2)", text)
    text = re.sub(r"\[([^]]+)\]\([^)]+\)", r"\1", text)
    text = re.sub(r"\*\*([^*]+)\*\*", "\0B\\1\0R", text)
    text = re.sub(r"(?<!\w)\*([^* ][^*]*)\*", "\0I\\1\0R", text)
    lines = textwrap.wrap(" ".join(text.split(" ")), WIDTH - 10, break_long_words=False,
                          break_on_hyphens=False)
    lines = [re.sub("\0(.)", r"\\f\1", escape(line).replace("\1", " ")) for line in lines]
    return ["\\&" + line if line[0] in ".'" else line for line in lines]


class Page:
    """A page that grows from top to bottom."""

    def __init__(self, name, section, description, date, version, names=None):
        self.name, self.section = name, section
        kind = {1: "User Commands", 3: "Library Functions", 5: "File Formats"}[section]
        self.lines = ['.\\" SPDX-License-Identifier: MIT',
                      '.\\" SPDX-FileCopyrightText: The libada4571 authors',
                      f'.TH {name.upper()} {section} {date} "libada4571 {version}" "{kind}"']
        self.heading("NAME")
        listed = ", ".join(escape(n) for n in names or [name]) + " \\- " + escape(description)
        self.lines += textwrap.wrap(listed, WIDTH, break_on_hyphens=False)
        self._open = True

    def heading(self, text):
        self.lines.append(f".SH {text.upper()}")
        self._open = True

    def subheading(self, text):
        self.lines.append(f".SS {escape(text)}")
        self._open = True

    def _gap(self):
        """A paragraph's beginning, which directly below a heading is none."""
        if not self._open:
            self.lines.append(".PP")
        self._open = False

    def paragraph(self, text):
        self._gap()
        self.lines += prose(text)

    def literal(self, text):
        self._gap()
        rows = [escape(row) for row in text.strip("\n").split("\n")]
        rows = ["\\&" + row if row[:1] in (".", "'") else row for row in rows]
        self.lines += [".nf"] + [row or "\\&" for row in rows] + [".fi"]

    def synopsis(self, command, words):
        """`words` are roff already."""
        self._gap()
        rest = " ".join(word.replace(" ", "\0") for word in words)
        wrapped = textwrap.wrap(rest, WIDTH, break_long_words=False, break_on_hyphens=False)
        self.lines += [f"\\fB{escape(command)}\\fR"] + [row.replace("\0", "\\ ") for row in wrapped]

    def tagged(self, tag, text):
        """`tag` is roff already."""
        self._open = False
        self.lines += [".TP", tag] + (prose(text) or ["\\&"])

    def see_also(self, pages):
        self.heading("SEE ALSO")
        pages = [page for page in pages if page != (self.name, self.section)]
        for name, section in pages:
            comma = "" if (name, section) == pages[-1] else " ,"
            self.lines.append(f".BR {escape(name)} ({section}){comma}")

    def write(self, folder):
        target = folder / f"man{self.section}" / f"{self.name}.{self.section}"
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text("\n".join(self.lines) + "\n", encoding="ascii")


def _blocks(text):
    """Markdown cut at empty lines, fenced and indented code kept whole."""
    fenced, block = False, []
    for line in text.split("\n") + [""]:
        if line.startswith("```"):
            fenced = not fenced
        if line.strip() or fenced:
            block.append(line)
        elif block and block[0].startswith("    "):
            block.append(line)
        elif block:
            yield block
            block = []
        if block and not fenced and len(block) > 1 and line.startswith("    ") is False \
                and block[0].startswith("    ") and line.strip():
            yield block[:-1]
            block = [line]
    if block:
        yield block


def _cells(row):
    return [cell.strip().replace("\\|", "|") for cell in
            re.split(r"(?<!\\)\|", row.strip().strip("|"))]


def _table(page, rows):
    names = _cells(rows[0])
    for row in rows[2:]:
        cells = _cells(row)
        said = [f"{name}: {cell}" if number > 0 and name and len(names) > 2 else cell
                for number, (name, cell) in enumerate(zip(names[1:], cells[1:])) if cell]
        page.tagged(" ".join(prose(cells[0])), "; ".join(said))


def markdown(page, text):
    """Headings from ## on are sections of the page."""
    for block in _blocks(text):
        first = block[0]
        if first.startswith("## "):
            page.heading(escape(first[3:]))
        elif first.startswith("#"):
            page.subheading(first.lstrip("# "))
        elif first.startswith("```"):
            page.literal("\n".join(block[1:-1]))
        elif first.startswith("    "):
            page.literal(textwrap.dedent("\n".join(block)))
        elif first.startswith("|"):
            _table(page, block)
        elif re.match(r"([*-]|\d+\.) ", first):
            for item in re.split(r"\n(?=(?:[*-]|\d+\.) )", "\n".join(block)):
                mark, said = re.match(r"([*-]|\d+\.) +(.*)", item, re.S).groups()
                page.lines += [".IP \\(bu 2" if mark in "*-" else f".IP {mark} 4"]
                page.lines += prose(" ".join(said.split()))
                page._open = False
        else:
            page.paragraph(" ".join(" ".join(block).split()))
