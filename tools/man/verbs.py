#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""verbs.py DEFINITIONS.json NOTES.md FOLDER DATE VERSION: section 1, a page for the program and one
a verb, from the program's own definitions; NOTES.md has what is more than options."""
import json
import pathlib
import re
import sys

import roff

PROGRAM = "iio-angle"
EXIT_STATUS = "0 done; 1 the data or the device is unusable, or a check failed; 2 wrong usage. " \
              "Results go to standard output, everything else to standard error."


def stop(text):
    """As --help has it, but with a full stop."""
    return text + ("" if text.endswith(".") else ".")


def sentence(text):
    return stop(text[:1].upper() + text[1:])


def choices(option):
    """The words that an option takes, where it takes no others."""
    text = option["limits"]
    return text.strip("{}").replace(",", "|") if text[:1] == "{" or "|" in text else ""


def word(option):
    """An option as it is typed."""
    names = ", ".join(f"\\fB{roff.escape(name)}\\fR" for name in option["names"])
    value = option["type"] or choices(option)
    value = f"\\fI{roff.escape(value)}\\fR" if value else ""
    return " ".join(part for part in (names, value) if part)


def brief(option):
    """The same in the synopsis: one name, brackets where it may be left out."""
    text = word({**option, "names": option["names"][-1:]})
    text += " ..." if option["many"] else ""
    return text if option["required"] else f"[{text}]"


def limits(option):
    """What CLI11 notes down of its checks, in words."""
    text = option["limits"]
    numbers = re.search(r"in \[(\S+) - (\S+)\]", text)
    words = {"POSITIVE": "Above 0.", "NONNEGATIVE": "0 or above."}.get(text, "")
    if numbers:
        words = f"From {numbers[1]} to {numbers[2]}."
    if option["default"]:
        words += f" Default: {option['default']}."
    return words.strip()


def all_options(verb):
    return verb["options"] + [option for group in verb["groups"] for option in group["options"]]


def synopsis(page, name, verb):
    words = [brief(option) for option in verb["options"] if not option["positional"]]
    for group in verb["groups"]:
        inside = " | ".join(word({**o, "names": o["names"][-1:]}) for o in group["options"])
        words.append(f"({inside})" if group["options_required"] else f"[{inside}]")
    words += [brief(option) for option in verb["options"] if option["positional"]]
    page.synopsis(name, words)


def options(page, verb):
    for option in sorted(all_options(verb), key=lambda o: not o["positional"]):
        group = next((g["description"] for g in verb["groups"] if option in g["options"]), "")
        text = stop(option["description"]) + " " + limits(option)
        page.tagged(word(option), text + (" " + stop(group) if group else ""))


def examples(page, footer):
    """Lines that are indented are typed, the others are said."""
    for part in re.findall(r"(?:^  .*\n?)+|^(?!  ).+\n?", footer.removeprefix("Example:\n"), re.M):
        if part.startswith("  "):
            page.literal(re.sub(r"^  ", "", part, flags=re.M))
        elif not part.startswith("Exit status:"):
            page.paragraph(" ".join(part.split()))


def note(notes, title):
    found = re.search(rf"^# {re.escape(title)}\n(.*?)(?=^# |\Z)", notes, re.M | re.S)
    return found[1].strip() if found else ""


def verb_page(verb, notes, date, version):
    page = roff.Page(f"{PROGRAM}-{verb['name']}", 1, verb["description"], date, version)
    parts = [(f"{PROGRAM} {verb['name']} {part['name']}", part) for part in verb["verbs"]]
    parts = parts or [(f"{PROGRAM} {verb['name']}", verb)]
    page.heading("SYNOPSIS")
    for name, part in parts:
        synopsis(page, name, part)
    page.heading("DESCRIPTION")
    page.paragraph(sentence(verb["description"]))
    roff.markdown(page, note(notes, verb["name"]))
    page.heading("OPTIONS")
    for name, part in parts:
        if part is not verb:
            page.subheading(f"{name}: {part['description']}")
        options(page, part)
        if not all_options(part):
            page.paragraph("None but `--help`.")
    page.heading("EXIT STATUS")
    page.paragraph(EXIT_STATUS)
    page.heading("EXAMPLES")
    for _, part in parts:
        examples(page, part["footer"])
    return page


def program_page(program, notes, date, version):
    page = roff.Page(PROGRAM, 1, "angles from analog sine/cosine angle sensors", date, version)
    page.heading("SYNOPSIS")
    page.synopsis(PROGRAM, ["\\fIVERB\\fR", "[\\fIOPTIONS\\fR]"])
    page.heading("DESCRIPTION")
    roff.markdown(page, note(notes, PROGRAM))
    page.heading("VERBS")
    for verb in program["verbs"]:
        page.tagged(f"\\fB{PROGRAM}\\-{verb['name']}\\fR(1)", sentence(verb["description"]))
    roff.markdown(page, note(notes, "more"))
    page.heading("EXIT STATUS")
    page.paragraph(EXIT_STATUS)
    page.heading("EXAMPLES")
    examples(page, program["footer"])
    return page


def main(definitions, notes, folder, date, version):
    program = json.loads(pathlib.Path(definitions).read_text(encoding="utf-8"))
    notes = pathlib.Path(notes).read_text(encoding="utf-8")
    pages = [program_page(program, notes, date, version)]
    pages += [verb_page(verb, notes, date, version) for verb in program["verbs"]]
    related = [(PROGRAM, 1), ("libada4571", 3), ("ada4571-capture", 5), ("ada4571-model", 5),
               ("ada4571-config", 5)]
    for page in pages:
        page.see_also(related)
        page.write(pathlib.Path(folder))


if __name__ == "__main__":
    main(*sys.argv[1:])
