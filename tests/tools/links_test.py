#!/usr/bin/env python3
"""Checks the relative links of all pages (*.md): the file must be there, and the heading that follows '#'.

    links_test.py SOURCE    (the repository's root)

Exit status: 0 if every link leads somewhere, 1 otherwise.
"""
import pathlib
import re
import sys

SKIPPED = {"build", "demo-output", ".git"}


def anchors_of(page):
    """Returns the anchors of a page's headings as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def dead_links(page):
    """Yields the links of a page that lead nowhere."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        path, _, anchor = link.partition("#")
        if re.match(r"[a-z]+:", path):
            continue  # to another site
        target = (page.parent / path) if path else page
        if not target.exists() or (anchor and anchor not in anchors_of(target)):
            yield link


def main():
    source = pathlib.Path(sys.argv[1]).resolve()
    pages = [page for page in source.rglob("*.md") if not SKIPPED & set(page.relative_to(source).parts)]
    found = [f"{page.relative_to(source)}: the link {link} leads nowhere" for page in pages for link in dead_links(page)]
    print("\n".join(found))
    sys.exit(1 if found or not pages else 0)


if __name__ == "__main__":
    main()
