"""Every relative link of the documents leads to a file, and to a heading of it: python3 tests/links_test.py"""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
FENCED = re.compile(r"^```.*?^```", re.DOTALL | re.MULTILINE)
QUOTED = re.compile(r"`[^`\n]*`")
# A page that a source names, such as bench/skip.md.
MENTION = re.compile(r"\b(?:bench|docs|training)/[\w/]+\.md\b")
SOURCES = {".cpp", ".h", ".comp", ".glsl", ".py", ".sh", ".txt", ".md"}


def files():
    for folder in [ROOT, *(path for path in ROOT.iterdir() if path.is_dir() and path.name != "build" and path.name[0] != ".")]:
        yield from (path for path in (folder.glob("*") if folder == ROOT else folder.rglob("*")) if path.suffix in SOURCES)


def text_of(path):
    return path.read_text(encoding="utf-8")


def anchors(page):
    """The headings of a page, as GitHub names them."""
    headings = re.findall(r"^#+ +(.*)$", FENCED.sub("", text_of(page)), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken_links(page):
    for target in LINK.findall(QUOTED.sub("", FENCED.sub("", text_of(page)))):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        file = page.parent / path if path else page
        if not file.exists() or (anchor and anchor not in anchors(file)):
            yield target


class Links(unittest.TestCase):
    def test_links_of_documents_lead_somewhere(self):
        broken = {str(page.relative_to(ROOT)): found for page in files() if page.suffix == ".md" if (found := list(broken_links(page)))}
        self.assertEqual(broken, {})

    def test_pages_that_sources_name_are_there(self):
        missing = {f"{path.relative_to(ROOT)}: {name}" for path in files() if path.name != "CHANGELOG.md"
                   for name in MENTION.findall(text_of(path)) if not (ROOT / name).exists()}
        self.assertEqual(missing, set())


if __name__ == "__main__":
    unittest.main()
