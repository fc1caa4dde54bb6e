#!/usr/bin/env python3
"""Makes the browsable manual: the README and every page of doc/ as HTML, beside FORD's reference of the library.

Usage: manual.py FOLDER, where FOLDER/api holds what FORD made. Pandoc turns Markdown into HTML and its formulas into
MathML: the pages need no network and no script. Links between pages lead to pages, those to sources into FORD's
reference; in the end every link of the pages is followed.
"""
import html
import html.parser
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parents[2]
BOOTSTRAP = Path("/usr/share/javascript/bootstrap5")
# The order in which one reads; pages that are not named here follow.
ORDER = ["README", "guide", "decks", "output", "limits", "theory", "methods", "library", "verification", "performance",
         "peers", "architecture"]
STYLE = """
body { font: 16px/1.55 system-ui, sans-serif; color: #222; margin: 0; display: flex; flex-wrap: wrap }
nav { flex: 0 0 15rem; box-sizing: border-box; padding: 1.5rem 1rem; background: #f4f6f8 }
nav a { display: block; padding: .2rem .5rem }
nav a[aria-current] { font-weight: 600; background: #dde5ec; border-radius: .3rem }
nav .part { padding-left: 1.3rem; font-size: .85em; line-height: 1.35 }
@media (min-width: 45.1rem) {
   nav { position: sticky; top: 0; align-self: flex-start; max-height: 100vh; overflow-y: auto } }
main { flex: 1 1 20rem; min-width: 0; max-width: 60rem; padding: 0 2rem 4rem }
a { color: #00558a; text-decoration: none }
a:hover { text-decoration: underline } h1, h2, h3 { line-height: 1.25; margin-top: 2rem }
pre { background: #f5f5f5; padding: .8rem; overflow-x: auto; font-size: 13.5px } code { font-size: .9em }
pre.console { white-space: pre-wrap }
table { border-collapse: collapse; display: block; overflow-x: auto } img { max-width: 100%; height: auto }
th, td { padding: .3rem .6rem; border-bottom: 1px solid #ddd; text-align: left; vertical-align: top }
math[display=block] { margin: 1rem 0; overflow-x: auto }
@media (max-width: 45rem) { nav { flex-basis: 100%; padding: .5rem 1rem } nav a { display: inline-block }
   table { font-size: 14px } th, td { padding: .3rem .35rem }
   col { width: auto !important } td:last-child { min-width: 9rem }
   main { padding: 0 1rem 3rem } }
@media print { nav { display: none } }
"""
PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title} · Amontons</title>
<link rel="icon" href="data:,">
<style>{style}</style>
</head>
<body>
<nav>
{links}
</nav>
<main>
{body}
</main>
</body>
</html>
"""


def sources():
    """The Markdown file of every page, in the order in which one reads; FORD's own settings are none."""
    files = [ROOT / "README.md", *sorted((ROOT / "doc").glob("*.md"))]
    names = [*ORDER, *(file.stem for file in files)]
    return sorted((file for file in files if file.stem != "ford"), key=lambda file: names.index(file.stem))


def name_of(source):
    """The HTML file of a page."""
    return "index.html" if source.stem == "README" else f"{source.stem}.html"


def title_of(source):
    """The first heading of a page."""
    return re.search(r"^# (.*)$", source.read_text(encoding="utf-8"), re.MULTILINE)[1]


def body_of(source):
    """A page as HTML."""
    text = source.read_text(encoding="utf-8")
    text = re.sub(r"^```math\n(.*?)^```$", r"$$\n\1$$", text, flags=re.MULTILINE | re.DOTALL)
    return subprocess.run(["pandoc", "--from", "gfm+tex_math_dollars", "--to", "html", "--mathml"], input=text,
                          check=True, capture_output=True, encoding="utf-8").stdout


def resolved(target, source, folder):
    """Where a link of a page leads in the manual; a picture is put there."""
    name, hash_sign, anchor = target.partition("#")
    if not name or re.match("[a-z]+:", name):
        return target
    file = (source.parent / unquote(name)).resolve()
    if file in sources():
        name = name_of(file)
    elif file.suffix == ".f90" and (folder / "api/sourcefile" / f"{file.name}.html").exists():
        name = f"api/sourcefile/{file.name}.html"
    elif file.suffix in (".png", ".svg"):
        name = f"images/{file.name}"
        (folder / "images").mkdir(exist_ok=True)
        shutil.copy(file, folder / name)
    else:
        name = os.path.relpath(file, folder)
    return name + hash_sign + anchor


def parts_of(body):
    """Links to the sections of a page, from its headings."""
    return "".join(f'\n<a class=part href="#{name}">{re.sub("<[^>]*>", "", heading).strip()}</a>'
                   for name, heading in re.findall(r'<h2\s+id="([^"]*)">(.*?)</h2>', body, re.DOTALL))


def write_page(source, folder):
    """Writes a page into the manual, beside links to all pages and to its own sections."""
    body = re.sub(r'\b(href|src)="([^"]*)"', lambda match: f'{match[1]}="{resolved(match[2], source, folder)}"',
                  body_of(source))
    entries = [(name_of(other), title_of(other)) for other in sources()] + [("api/index.html", "Library, by module")]
    own = name_of(source)
    links = "\n".join(f'<a href="{name}"{" aria-current=page" * (name == own)}>{html.escape(title)}</a>'
                      + parts_of(body) * (name == own) for name, title in entries)
    (folder / own).write_text(PAGE.format(title=html.escape(title_of(source)), style=STYLE, links=links,
                                                      body=body), encoding="utf-8")


def make_local(folder):
    """Makes FORD's pages do without the network: Bootstrap from Debian, no MathJax since no comment has formulas."""
    for name, kind in (("bootstrap.min.css", "css"), ("bootstrap.bundle.min.js", "js")):
        shutil.copy(BOOTSTRAP / kind / name, folder / kind / name)
    for page in folder.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        up = "../" * (len(page.relative_to(folder).parts) - 1)
        text = re.sub(r'"https://cdn[^"]*/bootstrap@[^"]*/(css|js)/([^"]*)"', rf'"{up}\1/\2"', text)
        text = re.sub(r'\s+integrity="[^"]*" crossorigin="[^"]*"', "", text)
        text = re.sub(r"<script[^>]*(?:mathjax@|x-mathjax)[^>]*>.*?</script>", "", text, flags=re.DOTALL)
        page.write_text(text, encoding="utf-8")


class Reader(html.parser.HTMLParser):
    """The links and the anchors of a page."""

    def __init__(self, page):
        super().__init__()
        self.targets, self.anchors = [], set()
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        for name, value in attrs:
            if name in ("href", "src"):
                self.targets.append(value)
            elif name in ("id", "name"):
                self.anchors.add(value)


def broken_links(folder):
    """Page and target of every link of the manual's own pages that leads nowhere."""
    readers = {page: Reader(page) for page in sorted(folder.glob("*.html"))}
    for page, reader in readers.items():
        for target in reader.targets:
            name, _, anchor = target.partition("#")
            if re.match("[a-z]+:", name):
                continue
            file = (folder / unquote(name)).resolve() if name else page
            if not file.exists() or anchor and file in readers and unquote(anchor) not in readers[file].anchors:
                yield page.name, target


def main():
    """Makes the manual; returns the exit status."""
    folder = Path(sys.argv[1]).resolve()
    make_local(folder / "api")
    for source in sources():
        write_page(source, folder)
    broken = list(broken_links(folder))
    for page, target in broken:
        print(f"{page}: {target} leads nowhere")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
