"""Makes one page of a folder of solved cases: a table that sorts by any key result or key of the decks and can be
searched, a chart of any two of them, and of each case its verdict, warnings, pictures, files and deck; decks that
failed, with their messages. The page needs nothing beside it."""
from __future__ import annotations

import csv
import datetime
import html
import json
import os
import sys
import urllib.parse
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, Union

from amontons.cases import Case, dimension_of, find_cases
from amontons.commands import Parser
from amontons.numerals import scientific
from amontons.report_pictures import pictures_of
from amontons.verdicts import COLORS, verdict_of, violations

MANY = 8  # cases: from here on all cores draw
PARTS = ("lengths", "areas", "resultants", "counts")
FILES = (".lst", ".contact.csv", ".sweep.csv", ".history.csv", ".points.csv", ".summary.json", ".vtu", ".contact.vtu",
         ".sweep.pvd", ".history.pvd", ".deck.nml")
FAILED = ("refused", "numerical_failure", "system_failure", "interrupted")  # outcomes that leave no results
SHOWN = ("max_contact_pressure", "max_von_mises", "max_displacement", "max_slip", "contact_width", "contact_width_1",
         "contact_width_2", "contact_width_3", "slip_length", "stick_length", "slip_area", "stick_area", "normal_force",
         "residual")
NAMES = ("case.name", "case.title")  # keys that say nothing of the body
LONGEST_LIST = 4  # values: the first of a longer list are taken
MOST_SHOWN = 4  # keys of the decks in the table; it sorts and draws by the others, too


def numbers_of(case: Case) -> dict[str, Any]:
    """The numbers of a case that a table can be sorted by; of a sweep, the greatest of its cases."""
    summary = case.summary
    found = {key: value["greatest"] for key, value in summary.get("extremes", {}).items()}
    for part in ("key_results", *PARTS):
        found.update(summary.get(part, {}))
    found.update({key: summary[key] for key in ("iterations", "residual") if key in summary})
    found["seconds"] = summary["seconds"]["total"]
    return found


def varied_keys(cases: list[Case]) -> list[dict[str, Any]]:
    """The keys that decks differ in, with their values in the deck of each case: numbers and words, those of a list one
    by one. Groups that some deck has more than once are numbered."""
    found: list[dict[str, Any]] = []
    decks = [case.deck for case in cases]
    repeated = {name for deck in decks for name, count in Counter(name for name, _ in deck).items() if count > 1}
    for deck in decks:
        numbers: Counter[str] = Counter()
        values: dict[str, Any] = {}
        # What a sweep replaces is not what the cases have.
        is_swept = any(name == "sweep" and "friction" in keys for name, keys in deck)
        for name, keys in deck:
            numbers[name] += 1
            group = f"{name}({numbers[name]})" if name in repeated else name
            for key, value in keys.items():
                if is_swept and (name, key) == ("contact", "friction"):
                    continue
                parts = value if isinstance(value, list) else [value]
                values.update({f"{group}.{key}" + f"({i})" * (len(parts) > 1): Path(one).name if key == "file" else one
                               for i, one in enumerate(parts[:LONGEST_LIST], start=1)})
        found.append({key: value for key, value in values.items() if key not in NAMES})
    keys = dict.fromkeys(key for values in found for key in values)
    varied = [key for key in keys if len({values.get(key) for values in found}) > 1]
    return [{key: values[key] for key in varied if key in values} for values in found]


def words_of(key: str) -> str:
    """The words for the name of a number."""
    return key.replace("_", " ").replace("von mises", "von Mises stress")


def heading_of(key: str, cases: list[Case]) -> str:
    """The heading of a number in the table of all cases; with its unit where all of them name the same ones."""
    counts = cases[0].summary.get("counts", {})
    has_unit = key not in counts and units_of(cases)
    return cases[0].label(words_of(key), dimension_of(key) if has_unit else "")


def units_of(cases: list[Case]) -> str:
    """The units that all cases name; empty if they name none, or others."""
    named = {case.summary.get("units") or "" for case in cases}
    return named.pop() if len(named) == 1 else ""


def cell_text(value: Union[float, str, None]) -> str:
    """A number in a table, or a word."""
    if value is None:
        return "–"
    if isinstance(value, str):
        return html.escape(value)
    if value and abs(value) < 1e-3:
        return scientific(value)
    return f"{float(f'{value:.5g}'):.6g}".replace("e+0", "e").replace("e+", "e")


def table_of(cases: list[Case], smalls: list[str]) -> str:
    """The table of all cases, what chooses its rows and their order, the chart, and the numbers of all these."""
    varied = varied_keys(cases)
    # Numbers before words, and what has most values first: sizes of a study before what sets one case apart.
    inputs = sorted(dict.fromkeys(key for found in varied for key in found),
                    key=lambda key: (any(isinstance(found.get(key), str) for found in varied),
                                     -len({found.get(key) for found in varied})))
    numbers = [{**given, **numbers_of(case)} for given, case in zip(varied, cases)]
    keys = list(dict.fromkeys(key for found in numbers for key in found if key not in inputs))
    labels = {"case": "case", "verdict": "verdict", **{key: key.replace(".", " ") for key in inputs},
              **{key: heading_of(key, cases) for key in keys}}
    common = [key for key in (*inputs, *SHOWN) if 2 * sum(key in found for found in numbers) > len(cases)]
    shown = [key for key in common if key in inputs][:MOST_SHOWN] + [key for key in common if key not in inputs]
    choice = "".join(f'<option value="{html.escape(key)}">{html.escape(label)}</option>'
                     for key, label in labels.items())
    head = "".join(f'<th data-key="{html.escape(key)}"{class_name}><button>{html.escape(labels[key])}</button></th>'
                   for key, class_name in [("case", ' class="name"'), ("verdict", ""), *[(key, "") for key in shown]])
    body, values = "", []
    for case, small, found in zip(cases, smalls, numbers):
        name, color = html.escape(case.summary["case"]), verdict_of(case.summary)[0]
        title = html.escape(case.summary.get("title") or "")
        cells = "".join(f'<td data-label="{html.escape(labels[key])}"'
                        f'{" class=word" * isinstance(found.get(key), str)}>{cell_text(found.get(key))}</td>'
                        for key in shown)
        body += (f'<tr><td><a href="#{name}">{small}</a></td><td class="name"><a href="#{name}">{name}</a>'
                 f'<span class="title">{title}</span></td><td class="mark {color}">{color}</td>{cells}'
                 "<td hidden></td></tr>\n")
        values.append({"case": case.summary["case"], "verdict": COLORS.index(color), **found})
    measured = [key for key in labels if key not in ("case", "verdict")
                and any(isinstance(found.get(key), (int, float)) for found in numbers)]
    results = [key for key in (*SHOWN, *keys) if key in measured]
    # Cases without a solution have no results.
    over = [key for key in (*common, *inputs) if key in inputs and key in measured] or measured[-1:]
    data = json.dumps({"labels": labels, "inputs": inputs, "cases": values, "colors": COLORS,
                       "chart": [*over[:1], *results[:1]]}).replace("<", "\\u003c")
    axes = "".join(f'<option value="{html.escape(key)}">{html.escape(labels[key])}</option>' for key in measured)
    is_open = " open" * any(key in inputs for key in over)
    chart = f"""<details class="chart"{is_open}><summary>Chart</summary><div class="tools">
<label>Over <select id="over">{axes}</select></label> <label>draw <select id="drawn">{axes}</select></label></div>
<svg id="chart" viewBox="0 0 720 360" role="img" aria-label="chart of the cases"></svg></details>
""" if len(cases) > 1 and results else ""
    # Of one case there is nothing to search and sort.
    return f"""<div class="tools"{" hidden" * (len(cases) < 2)}><label>Search <input type="search" id="find"
placeholder="bar friction&gt;0.3" title="words of names, titles and values that differ; a number with &lt;, &gt; or =">
</label>
<span id="count" role="status"></span><label>Sort by <select id="by">{choice}</select></label>
<label><input type="checkbox" id="down"> largest first</label></div>
{chart}<div class="wide"{" hidden" * (not cases)}><table class="cases">
<thead><tr><th></th>{head}<th hidden></th></tr></thead><tbody>
{body}</tbody></table></div>
<script type="application/json" id="results">{data}</script>
"""


def key_results_of(case: Case) -> str:
    """The key results of a case, with the places of those that have one; of a sweep their range, with its cases."""
    results = case.summary.get("key_results", {})
    places = {f"{key}_{axis}" for key in results for axis in "xyz" if f"{key}_x" in results}

    def place(key: str) -> str:
        """Where a key result is; empty if it has no place."""
        at = [cell_text(results[name]) for name in (f"{key}_{axis}" for axis in "xyz")
              if name in places and name in results]
        return f" at ({', '.join(at)}) {case.unit('L')}".rstrip() if at else ""

    texts = {key: cell_text(value) + place(key) for key, value in results.items() if key not in places}
    for key, ends in case.summary.get("extremes", {}).items():
        least, greatest = cell_text(ends["least"]), cell_text(ends["greatest"])
        texts[key] = least if least == greatest else \
            f"{least} (case {ends['least_case']}) to {greatest} (case {ends['greatest_case']})"
    entries = ""
    for key, text in texts.items():
        entries += f"<div><dt>{html.escape(case.label(words_of(key), dimension_of(key)))}</dt><dd>{text}</dd></div>"
    return f"<dl>{entries}</dl>\n" if entries else ""


def counted(count: int, noun: str) -> str:
    """A number of things in words."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def size_of(summary: dict[str, Any]) -> str:
    """How large a case is, in words; a reduced problem has contacts alone."""
    counts = {**summary["counts"], "cases": summary.get("sweep", {}).get("cases")}
    names = {"cases": "cases", "nodes": "nodes", "elements": "elements", "dofs": "unknowns",
             "contact_points": "contact points"}
    return ", ".join(f"{counts[key]} {name}" for key, name in names.items() if counts.get(key) is not None)


def deck_of(case: Case) -> tuple[str, str]:
    """The deck of a case as it runs anywhere: files that it names are beside it. Also what these files are."""
    text = Path(f"{case.path}.deck.nml").read_text(encoding="utf-8")
    inputs = case.summary.get("inputs", [])
    for entry in inputs:
        text = text.replace(f"'{entry['name'].replace(chr(39), 2 * chr(39))}'",
                            f"'{Path(entry['name']).name.replace(chr(39), 2 * chr(39))}'")
    needs = ", ".join(f"<code>{html.escape(Path(entry['name']).name)}</code> ({entry['bytes']} bytes, cksum "
                      f"{entry['checksum']})" for entry in inputs)
    return text, f"<p>Needs beside it: {needs}.</p>\n" if needs else ""


def section_of(case: Case, pictures: list[str]) -> str:
    """What the page says of one case."""
    summary = case.summary
    name, title = html.escape(summary["case"]), html.escape(summary.get("title") or "")
    color, sentence = verdict_of(summary)
    warnings = "".join(f'<p class="verdict amber"><b>warning</b><span>{html.escape(text)}</span></p>\n'
                       for text in summary.get("warnings", []))
    certificate = "".join(f"<tr><td>{key.replace('_', ' ')}</td><td>{cell_text(value)}</td></tr>"
                          for key, value in violations(summary).items())
    deck, needs = deck_of(case)
    stem = html.escape(Path(case.path).name)
    link = urllib.parse.quote(Path(case.path).name)
    files = ", ".join(f'<a href="{link}{ending}">{stem}{ending}</a>' for ending in FILES
                      if Path(case.path + ending).exists())
    is_one = ' one' if len(pictures) == 1 else ''
    return f"""<section data-case="{name}"><h2 id="{name}">{name}{": " + title if title else ""}</h2>
<p class="verdict {color}"><b>{color}</b><span>{html.escape(sentence)}</span></p>
{warnings}<p>{size_of(summary)}. Method {summary["method"]}, {counted(summary["iterations"], "iteration")}.</p>
{key_results_of(case)}<div class="figures{is_one}">{"".join(f"<div>{picture}</div>" for picture in pictures)}</div>
<p>Files: {files}</p>
<details><summary>Certificate: relative errors on the full model</summary>
<table>{certificate}</table></details>
<details><summary>Deck (<code>amontons {stem}.deck.nml</code>, version {summary["version"]})</summary>
<p><a download="{stem}.deck.nml" href="data:text/plain;charset=utf-8,{urllib.parse.quote(deck)}">Download</a></p>
{needs}<pre>{html.escape(deck)}</pre></details></section>
"""


def decks_of(folder: Path, outcomes: Sequence[str]) -> list[tuple[str, str]]:
    """The decks of a batch with some outcomes: pairs of deck and message."""
    try:
        with open(folder / "batch.csv", newline="", encoding="utf-8") as text:
            rows = list(csv.DictReader(text))
    except FileNotFoundError:
        return []
    return [(row["deck"], row["message"]) for row in rows if row["outcome"] in outcomes]


def without_deck(message: str, deck: str) -> str:
    """A message on a deck that is named beside it, with the word line before its line."""
    rest = message.removeprefix(f"{deck}:")
    return message if rest == message else "line " * rest[:1].isdigit() + rest.lstrip()


def drawn(numbered: tuple[int, str]) -> tuple[list[str], str]:
    """The pictures of a case that is numbered in its page, and the small one."""
    number, path = numbered
    return pictures_of(Case(path), f"c{number}")


def pictures_of_all(paths: list[str]) -> list[tuple[list[str], str]]:
    """The pictures of all cases, and the small ones."""
    if len(paths) < MANY:
        return list(map(drawn, enumerate(paths)))
    with ProcessPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        return list(pool.map(drawn, enumerate(paths), chunksize=4))


def page_of(folder: Path, paths: list[str]) -> str:
    """The page."""
    found = [Case(path) for path in paths]
    cases, answers = [case for case in found if case.has_state], [case for case in found if not case.has_state]
    without = [(case.summary["case"], case.summary["message"]) for case in answers]
    n_first = sum(case.summary["outcome"] == "not_converged" for case in answers)
    pictures = pictures_of_all([case.path for case in cases])
    failures = decks_of(folder, FAILED)
    colors = [verdict_of(case.summary)[0] for case in cases]
    tally = [f"{colors.count(color)} {color}" for color in COLORS]
    ends = ((len(without) - n_first, "without equilibrium"), (n_first, "without a first step"),
            (len(failures), "failed"))
    tally += [f"{n} {words}" for n, words in ends if n]
    versions = ", ".join(sorted({case.summary["version"] for case in found}))
    name = html.escape(folder.resolve().name)
    pvd = ' ParaView steps through <a href="cases.pvd">cases.pvd</a>.' if (folder / "cases.pvd").exists() else ""
    units = f"Units: {html.escape(units_of(found))}." if units_of(found) else \
        "Lengths, forces and stresses are in the units of the decks."
    others = (("red", "failed: ", failures), ("amber", "", without))
    unsolved = "".join(f'<p class="verdict {color}"><b>{words}{html.escape(deck)}</b><span>'
                       f"{html.escape(without_deck(message, deck))}</span></p>\n"
                       for color, words, some in others for deck, message in some)
    sections = "".join(section_of(case, large) for case, (large, _) in zip(cases, pictures))
    style, script = (Path(__file__).with_name(f"report.{ending}").read_text(encoding="utf-8")
                     for ending in ("css", "js"))
    return f"""<!DOCTYPE html>
<html lang="en">
<head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Amontons: {name}</title><style>{style}</style></head>
<body>
<h1>Contact results: {name}</h1>
<p>{counted(len(found), "case")}: {", ".join(tally)}.
Amontons {versions}; page made on {datetime.date.today().isoformat()}.
{units}{pvd}</p>
{unsolved}{table_of(cases, [small for _, small in pictures])}{sections}<script>
{script}</script></body>
</html>
"""


def parser() -> Parser:
    """The options of the command."""
    options = Parser(prog="amontons-report", description=__doc__)
    options.add_argument("folder", type=Path, metavar="FOLDER", help="where the cases are")
    options.add_argument("page", nargs="?", type=Path, metavar="PAGE",
                         help="the file to write (default: FOLDER/report.html)")
    return options


def main(arguments: Sequence[str]) -> int:
    """Makes the page of the folder that the arguments name. Returns the exit status."""
    options = parser().parse_args(arguments)
    page = options.page or options.folder / "report.html"
    try:
        if not options.folder.is_dir():
            sys.exit(f"report: {options.folder}: not a folder")
        page.write_text(page_of(options.folder, find_cases([options.folder])), encoding="utf-8")
    except OSError as error:
        sys.exit(f"report: {error.filename}: {error.strerror}")
    except ValueError as error:
        sys.exit(f"report: {error}")
    print(page)
    return 0
