#!/usr/bin/env python3
"""The command line: options, names of decks and of cases."""
import json
import re
import shutil
import unittest
from pathlib import Path
from xml.etree import ElementTree

from harness import CONTACT, HAS_SUITESPARSE, PRESSURE, PROGRAM, SOUND, SUPPORT, ProgramTest, block, results_of

MESHES = Path(__file__).resolve().parents[1] / "meshes"
SOLVED = (r"^case: solved, \d+ iterations, residual \d\.\d+e-\d+; open 0\.0, slip 0\.5, stick 3\.5; "
          r"9 of 9 points closed, peak pressure \d\.\d+\n$")


class Options(ProgramTest):
    """What each option does, and what is no option."""

    def setUp(self):
        super().setUp()
        self.write("case.nml", SOUND)

    def refuse(self, message, *arguments):
        run = self.run_program(*arguments, status=1)
        self.assertEqual(run.stderr, f"amontons: {message}\n")
        self.assertEqual(run.stdout, "")
        self.assertEqual(self.files(), ["case.nml"])

    def test_help_tells_every_option_and_status(self):
        for option in ("--help", "-h"):
            text = self.run_program(option).stdout
            self.assertIn("Usage: amontons [options] DECK...\n", text)
            options = ("--output DIR", "--set KEY=VALUE", "--check", "--quiet", "--threads N", "--all-solutions",
                       "--help", "--version")
            for word in (*options, *results_of("NAME")):
                self.assertIn(f"  {word}  ", text)
            for status in ("0 solved", "1 input refused", "2 no equilibrium", "3 cannot write", "4 not converged"):
                self.assertIn(status, text.replace("\n", " "))
        self.assertEqual(self.files(), ["case.nml"])

    def test_version(self):
        run = self.run_program("--version")
        facts = [r"amontons \d+\.\d+\.\d+", r"compiler     .*version \d+.*", r"build type   \w+.*",
                 r"BLAS         \S.*", r"SuiteSparse  (none|\d+\.\d+\.\d+, CHOLMOD \d+\.\d+\.\d+)",
                 r"MPI          (no|yes, MUMPS \d+\.\d+\.\d+)", r"OpenMP       20\d{4}, 1 threads"]
        self.assertRegex(run.stdout, "^" + "".join(fact + r"\n" for fact in facts) + "$")
        self.assertEqual(run.stderr, "")

    @unittest.skipIf(HAS_SUITESPARSE, "this build has SuiteSparse")
    def test_sparse_factorization_is_refused_without_suitesparse(self):
        self.write("sparse.nml", block(SUPPORT, PRESSURE, CONTACT, "solver factorization = 'sparse'"))
        for options in ([], ["--check"]):
            self.assertEqual(self.run_program(*options, "sparse.nml", status=1).stderr,
                             "sparse.nml: factorization = 'sparse' needs SuiteSparse, and this program was built "
                             "without it (AMONTONS_SUITESPARSE=OFF); choose 'auto', 'band' or 'multifrontal'\n")

    def test_former_word_of_a_factorization_is_read(self):
        self.write("former.nml", block(SUPPORT, PRESSURE, CONTACT, "solver factorization = 'substructured'"))
        self.assertIn(", multifrontal factor of ", self.run_program("--check", "former.nml").stdout)

    def test_help_and_version_solve_nothing(self):
        self.run_program("case.nml", "--help")
        self.run_program("--version", "case.nml")
        self.assertEqual(self.files(), ["case.nml"])

    def test_unknown_option(self):
        for word, hint in (("--outptu", "did you mean --output?"), ("--Quiet", "did you mean --quiet?"),
                           ("--ouput=x", "did you mean --output?"), ("--out", "did you mean --output?"),
                           ("-c", "did you mean --check?"), ("-output", "did you mean --output?"),
                           ("-j", "did you mean --threads?"), ("--dry-run", "did you mean --check?"),
                           ("-D", "did you mean --set?"), ("-v", "did you mean --version?"),
                           ("-x", "try amontons --help"), ("--ver", "try amontons --help"),
                           ("---", "try amontons --help")):
            self.refuse(f"unknown option '{word.removesuffix('=x')}'; {hint}", word, "case.nml")

    def test_short_options(self):
        self.refuse("-t expects a number of at least 1, found '0'", "-t=0", "case.nml")
        run = self.run_program("-q", "-t", "1", "-o", "results", "case.nml")
        self.assertEqual(run.stdout + run.stderr, "")
        self.assertEqual(sorted(self.contents("results")), results_of("case"))

    def test_help_fits_a_terminal_and_its_deck_can_be_solved(self):
        text = self.run_program("--help").stdout
        self.assertLessEqual(max(map(len, text.splitlines())), 82)
        deck = "".join(line + "\n" for line in text.splitlines() if line.startswith("  &"))
        self.assertEqual(deck.count("&"), 5)
        run = self.run_program("--output", "results", self.write("block.nml", deck))
        self.assertRegex(run.stdout, "^block: solved, ")

    def test_no_deck(self):
        for arguments in ((), ("--quiet",), ("--check", "--output", "results"), ("--",)):
            self.refuse("expected a deck; try amontons --help", *arguments)

    def test_value_missing_or_wrong(self):
        self.refuse("--output expects the name of a directory, found ''", "case.nml", "--output")
        self.refuse("--output expects the name of a directory, found ''", "--output=", "case.nml")
        for word in ("0", "-1", "two", "2.0", "", "99999999999"):
            self.refuse(f"--threads expects a number of at least 1, found '{word}'", "--threads", word, "case.nml")
            self.refuse(f"--threads expects a number of at least 1, found '{word}'", f"--threads={word}", "case.nml")
        for word in ("1", "two", ""):
            self.refuse(f"--refine expects a number of at least 2, found '{word}'", "--refine", word, "case.nml")
        self.refuse("--quiet takes no value", "--quiet=yes", "case.nml")
        self.refuse("--help takes no value", "--help=me")

    def test_output_directory_is_made_with_its_parents(self):
        for option in (["--output", "a/b c"], ["--output=d"], ["--output", "./e/"]):
            directory = option[-1].removeprefix("--output=")
            self.run_program("case.nml", *option)
            self.assertEqual(sorted(self.contents(directory)), results_of("case"))

    def test_output_directory_may_be_absolute(self):
        self.run_program("--output", self.directory / "absolute", "case.nml")
        self.assertEqual(sorted(self.contents("absolute")), results_of("case"))

    def test_results_go_to_the_current_directory(self):
        (self.directory / "decks").mkdir()
        self.write("decks/far.nml", SOUND)
        self.run_program("decks/far.nml")
        self.assertEqual(self.files(), sorted(["case.nml", "decks", "decks/far.nml", *results_of("far")]))

    def test_every_solved_deck_is_told_in_a_line(self):
        run = self.run_program("case.nml")
        self.assertRegex(run.stdout, SOLVED)
        self.assertEqual(run.stderr, "")

    def test_quiet_prints_nothing(self):
        run = self.run_program("case.nml", "--quiet")
        self.assertEqual(run.stdout + run.stderr, "")
        self.assertEqual(self.files(), sorted(["case.nml", *results_of("case")]))

    def test_check_solves_and_writes_nothing(self):
        run = self.run_program("--check", "--output", "results", "case.nml")
        self.assertRegex(run.stdout, r"^case: deck OK; 45 nodes, 32 elements, 85 unknowns, 9 contact points; "
                                     r"dense contact matrix of 18 rows, band factor of \d+ entries, "
                                     r"about \d+ MB of memory\n$")
        self.assertEqual(self.files(), ["case.nml"])
        self.assertEqual(self.run_program("--check", "--quiet", "case.nml").stdout, "")

    def test_check_counts_the_nodes_behind_cells(self):
        # The dense matrix of the nodes is four times as large as that of the cells.
        self.write("cells.nml", block(
            SUPPORT, PRESSURE, CONTACT + "  multipliers = 'constant'  cells = 400",
            mesh="size = 40.0, 1.0  cells = 400, 2  element = 'quad8'"))
        told = re.search(r"about (\d+) MB", self.run_program("--check", "cells.nml").stdout)
        self.run_program("--quiet", "--output", "results", "cells.nml")
        summary = json.loads((self.directory / "results" / "cells.summary.json").read_text(encoding="utf-8"))
        # What the program itself takes differs from system to system.
        self.assertAlmostEqual(int(told[1]), summary["peak_memory_mb"], delta=0.25 * summary["peak_memory_mb"])

    def test_check_finds_what_does_not_fit_the_mesh(self):
        self.write("tpo.nml", SOUND + "&load set = 'tpo'  pressure = 1.0 /")
        run = self.run_program("--check", "tpo.nml", "case.nml", status=1)
        self.assertEqual(run.stderr, "tpo.nml:6: the mesh has no set 'tpo'; its sets are: left, right, bottom, top; "
                         "did you mean 'top'?\n")
        self.assertIn("case: deck OK; ", run.stdout)

    def test_threads_change_no_digit(self):
        self.run_program("--quiet", "case.nml")
        expected = self.contents()["case.contact.csv"]
        for n_threads in ("1", "2", "7"):
            self.run_program("--threads", n_threads, "--output=with_threads", "case.nml")
            self.assertEqual(self.contents("with_threads")["case.contact.csv"], expected)
        self.run_command(["env", "-u", "OMP_NUM_THREADS", PROGRAM, "--output", "with_all_cores", "case.nml"])
        self.assertEqual(self.contents("with_all_cores")["case.contact.csv"], expected)


    def test_threads_change_no_digit_of_a_body_cut_in_two(self):
        # 65 000 unknowns: the first size that is cut.
        self.write("large.nml", block(SUPPORT, PRESSURE, CONTACT, "load set = 'right'  traction = 0.3, 0.0",
                                      mesh="size = 4.0, 2.0  cells = 256, 127"))
        for n_threads in ("1", "2"):
            run = self.run_program("--threads", n_threads, "--output", n_threads, "large.nml")
            self.assertRegex(run.stdout, "^large: solved, ")
        first, second = self.contents("1"), self.contents("2")
        self.assertIn(b"multifrontal, ", first["large.lst"])
        for name in ("large.contact.csv", "large.vtu"):
            self.assertTrue(first[name] == second[name], name)


class Settings(ProgramTest):
    """Values from the command line."""

    DECK = block(SUPPORT, PRESSURE, CONTACT, "load set = 'right'  traction(1) = 0.1, traction(2) = 0.0,")

    def effective_deck(self, *settings, deck=DECK):
        """The effective deck of a deck with settings."""
        self.write("case.nml", deck)
        self.run_program("--quiet", "--output", "results", *(f"--set={setting}" for setting in settings), "case.nml")
        return self.contents("results")["case.deck.nml"].decode()

    def refuse(self, setting, message, deck=DECK):
        self.write("case.nml", deck)
        run = self.run_program("--check", "--set", setting, "case.nml", status=1)
        self.assertEqual(run.stderr, f"case.nml:{message}\n   with --set {setting}\n")

    def test_value_takes_the_place_of_the_deck_s(self):
        expected = self.effective_deck(deck=self.DECK.replace("friction = 0.3", "friction = 0.5"))
        for setting in ("contact.friction=0.5", "CONTACT(1).Friction= 5e-1 ", "contact.friction=1*0.5"):
            self.assertEqual(self.effective_deck(setting), expected)
        expected = self.effective_deck(deck=self.DECK.replace("traction(1) = 0.1, traction(2) = 0.0,",
                                                              "traction = 0.2, -0.1"))
        self.assertEqual(self.effective_deck("load(2).traction=0.2,-0.1"), expected)

    def test_last_one_counts(self):
        self.assertEqual(self.effective_deck("contact.friction=0.7", "contact.friction=0.5"),
                         self.effective_deck("contact.friction=0.5"))

    def test_key_or_group_that_the_deck_has_not_is_added(self):
        more = "&solver method = 'psor'  omega = 1.5 /\n"
        expected = self.effective_deck(deck=self.DECK.replace("friction = 0.3", "friction = 0.3  extra_gap = 0.01")
                                       + more)
        self.assertEqual(self.effective_deck("contact.extra_gap=0.01", "solver.method=psor", "solver.omega=1.5"),
                         expected)
        self.assertEqual(self.effective_deck("solver.method='psor'", "contact.extra_gap=0.01", "solver.omega=1.5",
                                             deck=self.DECK.rstrip() + " ! end"), expected)

    def test_text_needs_no_quotes(self):
        deck = self.effective_deck("case.title=it's one, two", "mesh.element=tri3")
        self.assertIn("title = 'it''s one, two'", deck)
        self.assertIn("element = 'tri3'", deck)
        self.assertIn("title = '2.5'", self.effective_deck("case.title='2.5'"))

    def test_reduced_problem_takes_settings(self):
        self.write("case.nml", self.DECK + "&support point = 0.0, 2.0  uy = 0.0 /")
        self.run_program("--quiet", "--write-reduced", "case.nml")
        self.run_program("--quiet", "--reduced", "--set", "solver.method=psor", "case.reduced.dat")
        self.assertIn("method = 'psor'", self.contents()["case.reduced.deck.nml"].decode())

    def test_file_of_a_setting_counts_from_the_current_directory(self):
        shutil.copy(MESHES / "quad4-41.msh", self.directory / "block.msh")
        self.write("table.csv", "0.0 0.3\n4.0 0.3\n")
        deck = block("support set = 'right end'  ux = 0.01  uy = 0.0", "contact set = 'bottom'",
                     mesh="kind = 'file'  file = 'mine.msh'")
        for folder in ("one", "two"):
            (self.directory / folder).mkdir()
            self.write(f"{folder}/case_{folder}.nml", deck)
        settings = ("--set", "mesh(1).file=block.msh", "--set", "contact.friction_table=table.csv")
        self.run_program("--quiet", "--output", "results", *settings, "one/case_one.nml", "two/case_two.nml")
        for name in ("case_one", "case_two"):
            effective = self.contents("results")[f"{name}.deck.nml"].decode()
            self.assertIn(f"file = '{self.directory.resolve()}/block.msh'", effective)
            self.assertIn(f"friction_table = '{self.directory.resolve()}/table.csv'", effective)
        self.assertIn("verified", self.run_program("--verify", "results").stdout)
        # What the deck itself names is still seen from the deck's folder.
        (self.directory / "one" / "mine.msh").write_bytes((self.directory / "block.msh").read_bytes())
        self.run_program("--quiet", "--output", "more", "--set", "contact.friction=0.3", "one/case_one.nml")
        self.assertIn(f"file = '{self.directory.resolve()}/one/mine.msh'",
                      self.contents("more")["case_one.deck.nml"].decode())

    def test_faults_are_those_of_a_deck(self):
        for setting, message in (
                ("contact.friction=-1", "5: friction must be at least 0, found -1.0"),
                ("contact.mu=1", "5: unknown key 'mu' in &contact; did you mean friction?"),
                ("Contact.Mu=1", "5: unknown key 'Mu' in &contact; did you mean friction?"),
                ("contact.center=1,2", "5: unknown key 'center' in &contact; did you mean point?"),
                ("mesh.cells=4", "1: cells: expected 2 whole numbers, found 1"),
                ("material.young=stiff", "2: young: expected a number, found 'stiff' (column 19)"),
                ("case.title=2.5", "7: title: expected quoted text, found 2.5 (column 15)"),
                ("cotnact.friction=1", "7: unknown group &cotnact; did you mean &contact?"),
                ("load.pressure=1", " load.pressure=1: the deck has 2 &load; write load(1).pressure for the first"),
                ("load(3).pressure=1", " load(3).pressure=1: the deck has 2 &load; write load(1).pressure for the "
                 "first")):
            self.refuse(setting, message)

    def test_deck_that_is_refused_anyway(self):
        self.refuse("contact.friction=0.5", "5: &contact is not closed: expected '/' before &load in line 6",
                    self.DECK.replace("friction = 0.3 /", "friction = 0.3"))

    def test_what_is_no_setting(self):
        self.write("case.nml", self.DECK)
        for word in ("", "friction=0.5", "contact.friction", "contact.=1", ".friction=1", "contact(0).friction=1",
                     "contact(x).friction=1", "contact(1.friction=1", "contact(1)x.friction=1", "contact.cells(1)=1",
                     "=", "contact=0.5", "a b.c=1"):
            run = self.run_program("--set", word, "case.nml", status=1)
            self.assertEqual(run.stderr, "amontons: --set: expected GROUP.KEY=VALUE, such as contact.friction=0.3, "
                                         f"found '{word}'\n")
        run = self.run_program("--verify", "--set", "contact.friction=1", ".", status=1)
        self.assertIn("only --quiet and --threads go with it", run.stderr)


class Names(ProgramTest):
    """Names of decks, and of cases, that a careless program stumbles over."""

    def solve_and_list(self, deck, name):
        """Solves a deck and checks what its case is called, and that its effective deck is a deck."""
        directory = f"results of {name}"
        run = self.run_program("--output", directory, "--", deck)
        self.assertTrue(run.stdout.startswith(f"{name}: solved, "), run.stdout)
        self.assertEqual(sorted(self.contents(directory)), results_of(name))
        self.assertEqual(self.result(name, directory).summary["case"], name)
        run = self.run_program("--check", f"{directory}/{name}.deck.nml")
        self.assertTrue(run.stdout.startswith(f"{name}: deck OK; "), run.stdout)

    def test_deck_names(self):
        for name in ("two words", "it's", 'a "quoted" deck', "$HOME; `ls` & | *", "back\\slash", "r\u00f6we", ".hidden",
                     "%s", "a.b.c", "x"*200):
            with self.subTest(name=name):
                self.solve_and_list(self.write(f"{name}.nml", SOUND), name)

    def test_deck_whose_name_begins_with_a_dash(self):
        self.solve_and_list(self.write("--quiet.nml", SOUND), "--quiet")

    def test_deck_without_extension(self):
        self.solve_and_list(self.write("deck", SOUND), "deck")

    def test_case_names(self):
        for name in ("two words", "it''s", 'a "quoted" case', "-dash", "r\u00f6we", "..", "a,b;c"):
            with self.subTest(name=name):
                self.write("deck.nml", SOUND + f"&case name = '{name}' /")
                self.solve_and_list("deck.nml", name.replace("''", "'"))

    def test_name_of_a_deck_with_a_line_break_is_refused(self):
        run = self.run_program(self.write("two\nlines.nml", SOUND), status=1)
        self.assertEqual(run.stderr, "two\nlines.nml: name must be usable as a file name: 1 to 200 characters without "
                         "'/' and control characters\n")

    def test_title_with_quotes_backslash_and_tab(self):
        title = "\"A\" \\ 'b'\tc"
        summary = self.solve(SOUND + "&case title = '{}' /".format(title.replace("'", "''"))).summary
        self.assertEqual(summary["title"], title)

    def test_units_are_named(self):
        summary = self.solve(SOUND + "&case units = 'mm, N, MPa' /").summary
        self.assertEqual(summary["units"], "mm, N, MPa")
        listing = (self.directory/"case.lst").read_text(encoding="utf-8")
        self.assertIn("  Units               mm, N, MPa\n", listing)
        for pattern in (r"  Max\. pressure +[\d.]+ MPa at \(", r"  Contact width +4\.0 mm\n", r"  Force y +4\.0 N\n",
                        r"  Strain energy +[\d.e-]+ N mm\n", r"  Error of stresses +[\d.e-]+ sqrt\(N mm\)\n",
                        r"  Loads +\(.*\) N\n", r"\n  point .*\n( +mm){4}( +N){2}( +MPa){2}\n +1 "):
            self.assertRegex(listing, pattern)
        self.run_program("--verify", ".")
        self.assertEqual(self.solve(SOUND).summary["units"], "")
        plain = (self.directory/"case.lst").read_text(encoding="utf-8")
        self.assertNotIn("  Units ", plain)
        self.assertNotRegex(plain, "mm|MPa")
        self.run_program("--verify", ".")

    def test_grids_have_units(self):
        self.solve(SOUND + "&case units = 'mm, k<N' /")
        expected = {"displacement": "mm", "contact_pressure": "k<N/mm^2", "von_mises": "k<N/mm^2", "points": "mm",
                    "error_norm": "sqrt(k<N mm)", "status": None, "offsets": None}
        found = {}
        for array in ElementTree.parse(self.directory/"case.vtu").iter("DataArray"):
            keys = array.findall("InformationKey[@name='UNITS_LABEL'][@location='vtkDataArray']")
            found[array.get("Name")] = keys[0].text if keys else None
        self.assertEqual({name: found[name] for name in expected}, expected)
        self.run_program("--verify", ".")
        other = (self.directory/"case.vtu").read_bytes().replace(b">mm<", b">in<", 1)
        (self.directory/"case.vtu").write_bytes(other)
        self.assertIn("case.vtu: it was changed", self.run_program("--verify", ".", status=4).stderr)


class Forms(ProgramTest):
    """A deck is the same deck in every form that editors give it."""

    def test_every_form_gives_the_same_results(self):
        forms = {
            "plain": SOUND,
            "windows": SOUND.replace("\n", "\r\n"),
            "marked": "\ufeff" + SOUND,
            "upper": SOUND.replace("&contact set", "&CONTACT SET").replace("friction", "FRICTION"),
            "one_line": SOUND.replace("\n", " "),
            "no_last_line_end": SOUND.rstrip(),
            "tabs": SOUND.replace(" ", "\t"),
            "legacy": SOUND.replace(" /", " &end"),
            "comments": "! R\u00f6we /\n" + SOUND.replace("\n", " ! & = '\n"),
            "long": SOUND + "! " + "x"*100000 + "\n"*1000,
            "other_order": "".join(reversed(SOUND.splitlines(keepends=True))),
        }
        expected = self.solve(SOUND, "expected").columns
        for name, text in forms.items():
            with self.subTest(form=name):
                self.assertEqual(self.solve(text, name).columns, expected)

    def test_deck_from_a_pipe(self):
        self.write("case.nml", SOUND)
        self.run_command(["sh", "-c", 'cat case.nml | "$0" --quiet /dev/stdin', PROGRAM])
        self.assertEqual(self.files(), sorted(["case.nml", *results_of("stdin")]))

    def test_deck_from_standard_input(self):
        self.write("far.nml", SOUND)
        (self.directory / "empty").mkdir()
        for script in ('cat far.nml | "$0" --quiet -', '"$0" --quiet - < far.nml', '"$0" --quiet -- - < far.nml'):
            self.run_command(["sh", "-c", script, PROGRAM])
            self.assertEqual(self.files(), sorted(["empty", "far.nml", *results_of("stdin")]))
            for name in results_of("stdin"):
                (self.directory / name).unlink()
        self.write("named.nml", SOUND.replace("friction", "friction_table = 'table.txt'  slip_bound") +
                   "&case name = 'named' /")
        self.write("table.txt", "0.0 0.3\n4.0 0.3\n")
        self.run_command(["sh", "-c", 'cat named.nml | "$0" --quiet --output results -', PROGRAM])
        self.assertEqual(sorted(self.contents("results")), results_of("named"))

    def test_faults_of_standard_input(self):
        for text, message in (("&mesh size = 4.0, 2.0  cells = 0, 4 /\n&material young = 1.0  poisson = 0.2 /",
                               "stdin:1: cells must be at least 1, found 0\n"), ("", "stdin: this file is empty\n"),
                              (SOUND.replace("'left'", "'tpo'"),
                               "stdin:3: the mesh has no set 'tpo'; its sets are: left, right, bottom, top; did you "
                               "mean 'top'?\n")):
            self.write("deck", text)
            run = self.run_command(["sh", "-c", '"$0" - < deck', PROGRAM], 1)
            self.assertEqual(run.stderr, message)
        run = self.run_command(["sh", "-c", '"$0" - <&-', PROGRAM], 1)
        self.assertEqual(run.stderr, "stdin: cannot read this file: Bad file descriptor\n")
        run = self.run_command(["sh", "-c", '"$0" - < .', PROGRAM], 1)
        self.assertEqual(run.stderr, "stdin: cannot read this file: Is a directory\n")
        run = self.run_program("--reduced", "-", status=1)
        self.assertEqual(run.stderr, "amontons: --reduced takes files; standard input (-) can only be a deck\n")

    def test_large_deck_from_a_slow_pipe(self):
        self.write("case.nml", SOUND)
        script = '{ cat case.nml; sleep 0.1; yes "! a comment" | head -n 100000; } | "$0" --check -'
        self.assertRegex(self.run_command(["sh", "-c", script, PROGRAM]).stdout, "^stdin: deck OK; ")

    def test_effective_deck_gives_the_same_results(self):
        text = block(SUPPORT, PRESSURE, CONTACT, "load body_force = 0.1, -0.2", "solver method = 'splitting'",
                     mesh="size = 4.0, 2.0  cells = 8, 4  element = 'tri3'  diagonal = 'alternating'  grading = 3.0")
        first = self.solve(text)
        self.run_program("--quiet", "--output", "again", "case.deck.nml")
        self.assertEqual(self.result("case", "again").columns, first.columns)
        again = self.contents("again")
        for name in ("case.contact.csv", "case.deck.nml", "case.vtu"):
            self.assertEqual(again[name], self.contents()[name])


if __name__ == "__main__":
    unittest.main()
