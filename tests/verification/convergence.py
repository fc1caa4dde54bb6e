"""Tables of a benchmark: errors against the mesh with the observed order, values beside references, round-off.

A table knows what is required of its rows, prints itself in Markdown, and tells the faults of the rows that miss it.
"""
import math
import re

# Observed orders approach the theoretical ones from either side. A study whose finest meshes are still on the way
# states its own allowance, with the reason.
ORDER_ALLOWANCE = 0.1
# What the ratio of the estimated to the true error of the stresses may be on the finest mesh.
EFFECTIVITY = (0.8, 1.25)
# Deviations that may be no larger than this are not printed, only their bound: they change with the machine.
ROUNDOFF = 1e-4
# Tables of values, and tables of any rows, with more rows are shortened in the page.
FEW_ROWS, FEW_ROWS_OF_ANY_KIND = 6, 10
# Cells of a sentence; longer ones are hard to read.
MOST_IN_A_SENTENCE = 10


def observed_order(coarse, fine):
    """The order between two rows (h, error)."""
    return math.log(coarse[1]/fine[1])/math.log(coarse[0]/fine[0])


class Table:
    """Rows of text under a caption and headings."""

    def __init__(self, caption, headings):
        self.caption = caption
        self.headings = headings
        self.rows = []
        self.faults = []

    def markdown(self):
        """The table with its caption."""
        return written_table(self.caption, self.headings, self.rows)

    def digest(self):
        """The table with its caption, as short as a page has room for: of many rows, the last two for each value of the
        first label."""
        if len(self.rows) <= FEW_ROWS_OF_ANY_KIND or self.faults:
            return self.markdown()
        rows = [row for group in distinct(row[0] for row in self.rows)
                for row in [row for row in self.rows if row[0] == group][-2:]]
        return written_table(f"{self.caption}: the last rows of {len(self.rows)}", self.headings, rows)

    def judge(self, is_right, text, row):
        """The text of a cell, marked, and a fault noted, where it is wrong."""
        if is_right:
            return text
        self.faults.append(f"{self.caption} {' '.join(map(str, row))}: {text}")
        return f"**{text}, FAILED**"


def written_table(caption, headings, rows):
    """A table in Markdown below its caption."""
    lines = [headings, ["---"]*len(headings), *rows]
    return "\n".join([caption, "", *("| " + " | ".join(map(str, line)) + " |" for line in lines)])


def distinct(values):
    """The different ones of some values, in their order."""
    return list(dict.fromkeys(values))


def varied(rows, labels):
    """The values that each label has in some rows."""
    return "; ".join(f"{label} {', '.join(map(str, distinct(row[column] for row in rows)))}"
                     for column, label in enumerate(labels))


class ConvergenceTable(Table):
    """Errors against the mesh size h, for some quantities and kinds of mesh, usually the elements.

    `orders` gives for every kind the order that each quantity must reach between the two finest meshes. A last column
    has the effectivity of the estimate, its ratio to the true error of the stresses, where it is given.
    """

    def __init__(self, caption, quantities, orders, kind="element", allowance=ORDER_ALLOWANCE):
        headings = [kind, "h"]
        for quantity in quantities:
            headings += [f"error of {quantity}", "order", "theory"]
        super().__init__(caption, headings)
        self.orders = orders
        self.allowance = allowance
        self.errors = {}
        self.effectivities = {}

    def add(self, kind, h, *errors, effectivity=None):
        """Adds a mesh; those of a kind follow each other, from coarse to fine."""
        self.errors.setdefault(kind, []).append((h, errors))
        if effectivity is not None:
            self.effectivities[kind, h] = effectivity

    def close(self):
        """Makes the rows, when all meshes are there."""
        if self.effectivities:
            self.headings.append("effectivity")
        for kind, meshes in self.errors.items():
            for number, (h, errors) in enumerate(meshes):
                row = [kind, f"{h:.4g}"]
                for error, least, coarser in zip(errors, self.orders[kind], self.coarser(kind, number)):
                    order = observed_order(coarser, (h, error)) if coarser else None
                    text = f"{order:.2f}" if coarser else ""
                    if number == len(meshes) - 1:
                        text = self.judge(order >= least - self.allowance, text, row)
                    row += [f"{error:.3e}", text, least]
                if self.effectivities:
                    ratio = self.effectivities[kind, h]
                    row.append(self.judge(number < len(meshes) - 1 or EFFECTIVITY[0] <= ratio <= EFFECTIVITY[1],
                                          f"{ratio:.2f}", row[:2]))
                self.rows.append(row)

    def digest(self):
        """Of the kinds of equal theory the one with the largest error on its finest mesh."""
        if self.faults:
            return self.markdown()
        finest, worst = {row[0]: row for row in self.rows}, {}
        for kind, row in finest.items():
            theory = tuple(self.orders[kind])
            if theory not in worst or float(row[2]) > float(worst[theory][2]):
                worst[theory] = row
        others = "" if len(worst) == len(finest) else f": the largest error of {len(finest)} kinds"
        return written_table(f"{self.caption}, finest mesh{others}", self.headings, worst.values())

    def coarser(self, kind, number):
        """The mesh before a mesh, as (h, error) of each quantity; nothing before the first."""
        if number == 0:
            return [None]*len(self.orders[kind])
        h, errors = self.errors[kind][number - 1]
        return [(h, error) for error in errors]


class ValueTable(Table):
    """Computed values beside their references: closed forms, or published numbers."""

    def __init__(self, caption, labels):
        super().__init__(caption, [*labels, "computed", "reference", "deviation", "allowed"])
        self.shares = []
        self.largest_allowance = 0.0

    def add(self, *labels, computed, reference, allowed):
        """Adds a value that may deviate by a part of the reference."""
        deviation = (computed - reference)/abs(reference)
        is_right = abs(deviation) <= allowed
        self.shares.append(abs(deviation)/allowed)
        self.largest_allowance = max(self.largest_allowance, allowed)
        if allowed >= ROUNDOFF:
            cells = [self.judge(is_right, f"{deviation:+.2%}", labels), f"{allowed:.2%}"]
        else:
            text = f"< {allowed:.0e}" if is_right else f"{deviation:+.1e}"
            cells = [self.judge(is_right, text, labels), f"{allowed:.0e}"]
        self.rows.append([*labels, f"{computed:.5g}", f"{reference:.5g}", *cells])


    def digest(self):
        """The rows where there are few; a sentence where all are exact; else, for each value of the first label, the
        row         furthest off."""
        if len(self.rows) <= FEW_ROWS:
            return self.markdown()
        if self.largest_allowance < ROUNDOFF and not self.faults:
            return (f"{self.caption}: within {self.largest_allowance:.0e} of the references in all "
                    f"{len(self.rows)} rows. Rows: {varied(self.rows, self.headings[:-4])}.")
        groups = distinct(row[0] for row in self.rows)
        rows = []
        for group in groups:
            members = [(share, row) for share, row in zip(self.shares, self.rows) if row[0] == group]
            rows.append([*max(members, key=lambda member: member[0])[1], len(members)])
        return written_table(self.caption + ": the row that is furthest off", [*self.headings, "of rows"], rows)


class RoundoffTable(Table):
    """Errors of what must be exact but for rounding; all but their bound changes with the machine."""

    def __init__(self, caption, labels, quantities, bound):
        super().__init__(caption, [*labels, *(f"error of {quantity}" for quantity in quantities)])
        self.labels = labels
        self.quantities = quantities
        self.bound = bound

    def add(self, *labels, errors):
        """Adds the errors of one case, each over the size of what it is an error of."""
        cells = []
        for error in errors:
            is_right = error <= self.bound
            text = f"< {self.bound:.0e}" if is_right else f"{error:.1e}"
            cells.append(self.judge(is_right, text, labels))
        self.rows.append([*labels, *cells])

    def digest(self):
        """A sentence: what was varied, and that all errors are below the bound; all rows if one is not."""
        if self.faults:
            return self.markdown()
        return (f"{self.caption}: the errors of {', '.join(self.quantities)} are below {self.bound:.0e} in all "
                f"{len(self.rows)} rows. Rows: {varied(self.rows, self.labels)}.")


def joined(tables):
    """Tables of equal headings that are shortened alike as one, their captions in its first column; sentences, which
    stand in the place of tables, as one list; tables of one row as sentences."""
    groups = {}
    for table in tables:
        caption, _, rows = table.partition("\n\n")
        name, _, note = re.fullmatch(r"(.*?)(, (?=finest mesh)|: (?=the )|$)(.*)", caption).groups()
        groups.setdefault((note, rows.partition("\n")[0]), []).append((name, table))
    parts = []
    for (note, headings), group in groups.items():
        if len(group) == 1 or headings and not note:
            parts += [table for _, table in group]
        elif not headings:
            parts.append("\n".join(f"* {table}" for _, table in group))
        else:
            rows = [f"| {name} {row}" for name, table in group for row in table.splitlines()[4:]]
            parts.append("\n".join([f"{note[0].upper()}{note[1:]}", "", f"| case {headings}",
                                    "| --- " + "| --- "*(headings.count("|") - 1) + "|", *rows]))
    return [sentence(part) for part in parts]


def sentence(table):
    """A table of one row as a sentence, each cell behind its heading; any other, and one of many columns, as it is."""
    caption, _, rows = table.partition("\n\n")
    headings, *lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in rows.splitlines()] or [[]]
    if len(lines) != 2 or len(headings) > MOST_IN_A_SENTENCE:
        return table
    return f"{caption}: {', '.join(f'{name} {cell}' for name, cell in zip(headings, lines[1]) if cell)}."
