"""Turns a folder of solved cases into one page that needs nothing beside it. Usage: amontons-report FOLDER [PAGE]

PAGE is FOLDER/report.html unless it is named.
"""

import base64
import datetime
import html
import io
import json
import pathlib
import sys
import urllib.parse

import matplotlib

from amontons import plot

VIOLATIONS = {
    "equilibrium": "the forces on some node do not balance",
    "penetration": "the body overlaps the obstacle",
    "tension": "the obstacle pulls at the body",
    "friction_excess": "friction bears more than it can",
    "complementarity": "the obstacle presses where there is a gap",
    "wrong_dissipation": "friction drives the slip somewhere",
    "slip_below_bound": "something slides though friction could hold it",
    "resultant": "the forces on the body do not add up to zero",
    "moment": "their moments do not add up to zero",
    "energy": "strain energy and work of the forces differ",
}
# A violation up to here leaves a picture that an engineer can use, and numbers that nobody should cite.
USABLE = 1e-4

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 70rem; margin: 2rem auto; padding: 0 1rem }
h1, h2 { line-height: 1.2 } h2 { border-top: 1px solid #ccc; padding-top: 1.5rem; margin-top: 2.5rem }
table { border-collapse: collapse; font-variant-numeric: tabular-nums } .wide { overflow-x: auto }
th, td { padding: .25rem .5rem; text-align: right; border-bottom: 1px solid #ddd; white-space: nowrap }
th { white-space: normal; vertical-align: bottom } th:first-child, td:first-child { text-align: left }
img { width: 100%; height: auto } pre { background: #f5f5f5; padding: .8rem; overflow-x: auto; font-size: 13px }
.verdict { padding: .5rem .8rem; border-left: .5rem solid; margin: 1rem 0 } .verdict b { margin-right: .5rem }
.green { background: #e6f4ec; border-color: #00724f } .amber { background: #fdf1dc; border-color: #b26b00 }
.red { background: #fbe6dd; border-color: #b03a00 } .mark { font-weight: bold } nav { margin: .5rem 0 }
a { color: #00558c }
@media screen and (max-width: 54rem) { img { width: 44rem } }
@media print {
  @page { margin: 1.2cm } body { max-width: none; margin: 0; padding: 0 } h2 { break-before: page; border: 0 }
  pre { white-space: pre-wrap; overflow: visible } .wide { overflow: visible } .overview { font-size: 9px }
  .overview :is(th, td) { padding: .2rem .25rem } details::details-content { content-visibility: visible }
}
"""


def violations(summary):
    """The violations in the certificate of a case, infinite where one is not a number; none of a sweep without a case
    that converged, which has no certificate."""
    certificate = summary.get("certificate", {})
    return {name: float("inf") if certificate[name] is None else certificate[name]
            for name in VIOLATIONS if name in certificate}


def verdict_of(summary):
    """The colour of a case, and the sentence that goes with it."""
    found_violations, residual = violations(summary), summary.get("residual")
    largest = max(found_violations.values(), default=float("inf"))
    what = "the file's own matrix" if "problem" in summary else "the full model"
    is_certified = bool(found_violations) and summary["certificate"]["passed"]
    faults = [VIOLATIONS[name] for name, value in found_violations.items() if value > summary["certificate"]["limit"]]
    found = f"On {what} {', '.join(faults)}. " if faults else ""
    if "sweep" in summary and not (summary["converged"] and is_certified):
        return verdict_of_sweep(summary["sweep"], is_certified, found)
    if summary["converged"] and is_certified:
        which = f"; certified is case {summary['certificate']['case']}, the one most in doubt" \
            if "sweep" in summary else ""
        color = "amber" if summary.get("warnings") else "green"
        return color, f"Solved and certified: on {what} every violation is at most {largest:.1e}, " \
            f"{summary['certificate']['limit']:.0e} being allowed{which}."
    if not summary["converged"]:
        found = f"The method stopped after {summary['iterations']} iterations at a residual of " \
                f"{number(residual)}. " + found
    if residual is not None and max(residual, largest) <= USABLE:
        return "amber", found + f"Nothing is off by more than {USABLE:.0e} of its scale: fit for a look, not for a " \
            "proof. Raise max_iterations, or take method = 'auto'."
    if summary["converged"]:
        return "red", found + "Do not use these numbers. The stiffness may be badly conditioned: look for slivers in " \
            "the mesh, for moduli that differ by many powers of ten, and for a Poisson's ratio close to 0.5."
    return "red", found + "Do not use these numbers. Take method = 'auto'; if that is what failed, raise " \
        "max_iterations, lower the friction in steps to see where it begins, or look whether the loads press the " \
        "body on its obstacle at all."


def verdict_of_sweep(counts, is_certified, found):
    """The same of a sweep that is not green."""
    left = []
    if counts["not_converged"]:
        left.append(f"{counts['not_converged']} did not converge: take method = 'auto', or raise max_iterations")
    if counts["no_equilibrium"]:
        left.append(f"{counts['no_equilibrium']} have no equilibrium, which is an answer: contact and friction cannot "
                    "balance these loads")
    found = f"Of {counts['cases']} cases " + "; ".join(left) + ". The column outcome tells which. " + found \
        if left else found
    if not counts["converged"]:
        return "red", found + "No case is solved."
    if not is_certified:
        return "red", found + "Do not use these numbers: the certificate of the case most in doubt failed."
    return "amber", found + "The others are solved, and the one most in doubt is certified."


def picture_of(case):
    """The picture of a case, to stand in the page itself."""
    content = io.BytesIO()
    plot.save_case(case, content)
    return "data:image/svg+xml;base64," + base64.b64encode(content.getvalue()).decode("ascii")


def row(cells, tag="td"):
    return "<tr>" + "".join(f"<{tag}>{cell}</{tag}>" for cell in cells) + "</tr>\n"


def number(value):
    return "–" if value is None else f"{value:.5g}"


def overview(summaries):
    """The table of all cases."""
    head = row(("case", "verdict", "open", "slip", "stick", "open length", "slip length", "stick length",
                "normal force", "tangential force", "iterations", "residual", "seconds"), "th")
    body = ""
    for summary in summaries:
        name, color = html.escape(summary["case"]), verdict_of(summary)[0]
        counts, lengths, resultants = (summary.get(part, {}) for part in ("counts", "lengths", "resultants"))
        body += row([f'<a href="#{name}">{name}</a>', f'<span class="mark {color}">{color}</span>']
                    + [counts.get(status, "–") for status in ("open", "slip", "stick")]
                    + [number(lengths.get(part)) for part in ("open_length", "slip_length", "stick_length")]
                    + [number(resultants.get(part)) for part in ("normal_force", "tangential_force")]
                    + [summary["iterations"],
                       f"{summary['residual']:.1e}" if summary.get("residual") is not None else "–",
                       number(summary["seconds"]["total"])])
    return f'<div class="wide"><table class="overview">{head}{body}</table></div>\n'


def size_of(summary):
    """How large a case is, in words; a reduced problem has contacts alone."""
    counts = {**summary["counts"], "cases": summary.get("sweep", {}).get("cases")}
    names = {"cases": "cases", "nodes": "nodes", "elements": "elements", "dofs": "unknowns",
             "contact_points": "contact points"}
    return ", ".join(f"{counts[key]} {name}" for key, name in names.items() if counts.get(key) is not None)


def section(case, summary):
    """What the page says of one case."""
    name, title = html.escape(summary["case"]), html.escape(summary["title"])
    color, sentence = verdict_of(summary)
    warnings = "".join(f'<p class="verdict amber"><b>warning</b>{html.escape(text)}</p>\n'
                       for text in summary.get("warnings", []))
    certificate = "".join(row([name.replace("_", " "), number(value)]) for name, value in violations(summary).items())
    deck = html.escape(pathlib.Path(f"{case}.deck.nml").read_text(encoding="utf-8"))
    stem = html.escape(pathlib.Path(case).name)
    link = urllib.parse.quote(pathlib.Path(case).name)
    files = ", ".join(f'<a href="{link}{ending}">{stem}{ending}</a>' for ending in
                      (".lst", ".contact.csv", ".sweep.csv", ".summary.json", ".vtu", ".contact.vtu", ".sweep.pvd",
                       ".deck.nml")
                      if pathlib.Path(case + ending).exists())
    return f"""<h2 id="{name}">{name}{": " + title if title else ""}</h2>
<p class="verdict {color}"><b>{color}</b>{html.escape(sentence)}</p>
{warnings}
<p>{size_of(summary)}. Method
{summary["method"]}, {summary["iterations"]} iterations.</p>
<div class="wide"><img src="{picture_of(case)}" alt="{name}, drawn"></div>
<p>Files: {files}</p>
<details><summary>Certificate: violations, each over its natural scale</summary>
<table>{certificate}</table></details>
<details><summary>Deck (run it again with <code>amontons {stem}.deck.nml</code>, version {summary["version"]})</summary>
<pre>{deck}</pre></details>
"""


def page_of(folder, cases):
    """The page."""
    summaries = [json.loads(pathlib.Path(case + plot.SUMMARY).read_text(encoding="utf-8")) for case in cases]
    colors = [verdict_of(summary)[0] for summary in summaries]
    versions = ", ".join(sorted({summary["version"] for summary in summaries}))
    name = html.escape(folder.resolve().name)
    pvd = ' ParaView steps through <a href="cases.pvd">cases.pvd</a>.' if (folder / "cases.pvd").exists() else ""
    counted = ", ".join(f"{colors.count(color)} {color}" for color in ("green", "amber", "red"))
    return f"""<!DOCTYPE html>
<html lang="en">
<head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Amontons: {name}</title><style>{STYLE}</style></head>
<body>
<h1>Contact results: {name}</h1>
<p>{len(cases)} {"case" if len(cases) == 1 else "cases"}: {counted}.
Amontons {versions}; page made on {datetime.date.today().isoformat()}.
Lengths, forces and stresses are in the units of the decks.{pvd}</p>
{overview(summaries)}{"".join(map(section, cases, summaries))}</body>
</html>
"""


def main(arguments):
    """Makes the page of the folder that the arguments name."""
    matplotlib.use("Agg")
    if len(arguments) not in (1, 2) or not pathlib.Path(arguments[0]).is_dir():
        sys.exit("report: name the folder of the cases, and, if it shall be another than report.html in it, the page")
    folder = pathlib.Path(arguments[0])
    page = pathlib.Path(arguments[1]) if len(arguments) > 1 else folder / "report.html"
    text = page_of(folder, plot.cases_of([folder]))
    page.write_text(text, encoding="utf-8")
    print(page)
