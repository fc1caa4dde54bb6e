"""Tables of a benchmark: errors against the mesh with the observed order, values beside references, round-off.

A table knows what is required of its rows, prints itself in Markdown, and tells the faults of the rows that miss it.
"""
import math
import re
import textwrap

# Observed orders approach the theoretical ones from either side. A study whose finest meshes are still on the way
# states its own allowance, with the reason.
ORDER_ALLOWANCE = 0.1
# What the ratio of the estimated to the true error of the stresses may be on the finest mesh.
EFFECTIVITY = (0.8, 1.25)
# Deviations that may be no larger than this are not printed, only their bound: they change with the machine.
ROUNDOFF = 1e-4
# Tables of any rows with more of them are shortened in the page.
FEW_ROWS = 9
# Columns of a line of the page, and headings that a sentence needs no word for.
WIDTH = 120
ALL_ELEMENTS = "tri3, quad4, tri6, quad8, quad9"
CLEAR = ("case", "contact", "element", "hypothesis", "quantity")


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
        first label. A table of another kind is a sentence, if no row is at fault."""
        if len(self.rows) <= FEW_ROWS or self.faults:
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
    lists = ((label, ", ".join(map(str, distinct(row[column] for row in rows)))) for column, label in enumerate(labels))
    return "; ".join(f"{label} {values}" if values != ALL_ELEMENTS else f"any {label}" for label, values in lists)


def named(headings, cells):
    """Cells with their headings, where those are needed, for a sentence."""
    return ", ".join(str(cell) if heading in CLEAR else f"{heading} {cell}" for heading, cell in zip(headings, cells))


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

    def findings(self):
        """For each kind, on its finest mesh: what it is to be compared with, its first error, and a sentence on it."""
        finest = {row[0]: row for row in self.rows}
        for kind, row in finest.items():
            errors = [f"{heading} {row[column]} of order {row[column + 1]} (theory {row[column + 2]})"
                      for column, heading in enumerate(self.headings) if heading.startswith("error of")]
            ratio = f" Effectivity {row[-1]}." if self.effectivities else ""
            yield ((*self.headings, *self.orders[kind]), float(row[2]),
                   f"{self.caption}, {named(self.headings[:2], row[:2])}: {', '.join(errors)}.{ratio}")

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
        """A sentence: that all are exact, or the row that takes the largest share of what is allowed."""
        if self.faults:
            return self.markdown()
        labels, count = self.headings[:-4], len(self.rows)
        if self.largest_allowance < ROUNDOFF:
            return (f"{self.caption}: within {self.largest_allowance:.0e} of the references in all {count} rows. "
                    f"Rows: {varied(self.rows, labels)}.")
        *cells, computed, reference, deviation, allowed = self.rows[self.shares.index(max(self.shares))]
        of_many = f" The nearest to its limit of {count} rows." if count > 1 else ""
        return (f"{self.caption}, {named(labels, cells)}: {computed} for {reference}, {deviation} where {allowed} is "
                f"allowed.{of_many}")


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


def digest(tables):
    """Tables as a page has room for them: a list of sentences, and the tables for which there is none. Of convergence
    studies with equal quantities and theory the one with the largest error is left."""
    sentences, counts, others = {}, {}, []
    for table in tables:
        if isinstance(table, ConvergenceTable) and not table.faults:
            for key, error, text in table.findings():
                counts[key] = counts.get(key, 0) + 1
                sentences[key] = max(sentences.get(key, (error, text)), (error, text))
        elif (text := table.digest()).count("\n"):
            others.append(text)
        else:
            sentences[table] = 0.0, text
    items = [text if counts.get(key, 1) == 1 else f"{text} The largest {key[2]} of {counts[key]} studies."
             for key, (_, text) in sentences.items()]
    lines = [textwrap.fill(item, WIDTH, initial_indent="* ", subsequent_indent="  ", break_long_words=False,
                           break_on_hyphens=False) for item in items]
    return ["\n".join(lines), *others] if lines else others
