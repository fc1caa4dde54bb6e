#!/usr/bin/env python3
"""The command line: options, names of decks and of cases."""
import unittest

from harness import CONTACT, PRESSURE, PROGRAM, SOUND, SUPPORT, ProgramTest, block, results_of

SOLVED = r"^case: solved, \d+ iterations, residual \d\.\d\dE-\d\d; separated 0\.0, sliding 0\.5, sticking 3\.5\n$"


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
            options = ("--output DIR", "--check", "--quiet", "--threads N", "--all-solutions", "--help", "--version")
            for word in (*options, *results_of("NAME")):
                self.assertIn(f"  {word}  ", text)
            for status in ("0 solved", "1 input refused", "2 numerical failure", "3 cannot write", "4 not converged"):
                self.assertIn(status, text.replace("\n", " "))
        self.assertEqual(self.files(), ["case.nml"])

    def test_version(self):
        run = self.run_program("--version")
        facts = [r"amontons \d+\.\d+\.\d+", r"compiler     GCC version \d+.*", r"build type   \w+.*",
                 r"BLAS         \S.*", r"SuiteSparse  \d+\.\d+\.\d+, CHOLMOD \d+\.\d+\.\d+",
                 r"HDF5         (yes|no)", r"OpenMP       20\d{4}, 1 threads"]
        self.assertRegex(run.stdout, "^" + "".join(fact + r"\n" for fact in facts) + "$")
        self.assertEqual(run.stderr, "")

    def test_help_and_version_solve_nothing(self):
        self.run_program("case.nml", "--help")
        self.run_program("--version", "case.nml")
        self.assertEqual(self.files(), ["case.nml"])

    def test_unknown_option(self):
        self.refuse("'--outptu' is no option; did you mean --output?; try amontons --help", "--outptu", "x", "case.nml")
        self.refuse("'--Quiet' is no option; did you mean --quiet?; try amontons --help", "case.nml", "--Quiet")
        self.refuse("'-q' is no option; try amontons --help", "-q", "case.nml")
        self.refuse("'--ouput' is no option; did you mean --output?; try amontons --help", "--ouput=x", "case.nml")

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
        self.assertRegex(run.stdout, r"^case: in order; 45 nodes, 32 elements, 85 unknowns, 9 contact points; "
                                     r"dense contact matrix of 18 rows, band factor of \d+ entries, "
                                     r"about \d+ MB of memory\n$")
        self.assertEqual(self.files(), ["case.nml"])
        self.assertEqual(self.run_program("--check", "--quiet", "case.nml").stdout, "")

    def test_check_tells_that_a_long_contact_line_takes_a_band_matrix(self):
        self.write("strip.nml", "&mesh size = 600.0, 1.0  cells = 600, 1 /\n"
                                "&material young = 100.0  poisson = 0.25 /\n"
                                "&support set = 'left'  ux = 0.0 /\n"
                                "&load set = 'top'  pressure = 1.0 /\n"
                                "&contact set = 'bottom'  friction = 0.3 /\n")
        self.assertIn("2402 unknowns, 601 contact points; band contact matrix of 2402 rows with half width 7, ",
                      self.run_program("--check", "strip.nml").stdout)

    def test_check_finds_what_does_not_fit_the_mesh(self):
        self.write("tpo.nml", SOUND + "&load set = 'tpo'  pressure = 1.0 /")
        run = self.run_program("--check", "tpo.nml", "case.nml", status=1)
        self.assertEqual(run.stderr, "tpo.nml:6: the mesh has no set 'tpo'; its sets are: left, right, bottom, top; "
                         "did you mean 'top'?\n")
        self.assertIn("case: in order; ", run.stdout)

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
        self.assertIn(b"substructured, ", first["large.lst"])
        for name in ("large.contact.csv", "large.vtu"):
            self.assertTrue(first[name] == second[name], name)


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
        self.assertTrue(run.stdout.startswith(f"{name}: in order; "), run.stdout)

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
                               "stdin:1: cells must be positive\n"), ("", "stdin: this file is empty\n"),
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
        self.assertRegex(self.run_command(["sh", "-c", script, PROGRAM]).stdout, "^stdin: in order; ")

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
