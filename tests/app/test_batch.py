"""Folders of decks solved by scripts/batch_parallel.sh and scripts/batch_slurm.sh."""
import csv
import os
import shutil
import unittest
from pathlib import Path

from harness import SOUND, SUFFIXES, ProgramTest, results_of

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


class Batch(ProgramTest):
    """Both scripts, on file names that need care."""

    def setUp(self):
        super().setUp()
        (self.directory / "my decks").mkdir()
        for name in ("one", "it's two"):
            self.write(f"my decks/{name}.nml", SOUND)

    def run_script(self, name, *arguments, status=0, **variables):
        """Runs a script with more environment variables."""
        words = [f"{key}={value}" for key, value in variables.items()]
        return self.run_command(["env", *words, SCRIPTS / f"{name}.sh", *arguments], status)

    def results(self):
        """The result files in the output folder."""
        return sorted(path.name for path in (self.directory / "out dir").iterdir() if path.is_file())

    @unittest.skipIf(shutil.which("parallel") is None, "GNU parallel is not installed")
    def test_every_deck_is_solved_and_logged(self):
        self.run_script("batch_parallel", "my decks", "out dir")
        self.assertEqual(self.results(), sorted(["batch.csv"] + results_of("one") + results_of("it's two")))
        log = self.directory / "out dir" / "batch"
        self.assertIn("one: solved", (log / "one.nml.log").read_text(encoding="utf-8"))
        self.assertEqual((log / "it's two.nml.status").read_text(encoding="utf-8"), "0\n")

    @unittest.skipIf(shutil.which("parallel") is None, "GNU parallel is not installed")
    def test_the_largest_status_counts_and_options_reach_the_program(self):
        self.write("my decks/wrong.nml", "&mesh /\n")
        self.run_script("batch_parallel", "--jobs", "1", "my decks", "out dir", "--quiet", status=1)
        self.assertEqual(len(self.results()), 2*len(SUFFIXES) + 1)
        log = (self.directory / "out dir" / "batch" / "one.nml.log").read_text(encoding="utf-8")
        self.assertEqual(log, "", "--quiet was handed on")

    def test_a_wrong_number_of_jobs_is_refused(self):
        for number in ("0", "two", ""):
            run = self.run_script("batch_parallel", "--jobs", number, "my decks", "out dir", status=1)
            self.assertEqual(run.stderr, "batch_parallel.sh: --jobs: expected a whole number, at least 1, found "
                             f"'{number}'\n")

    @unittest.skipIf(shutil.which("parallel") is None, "GNU parallel is not installed")
    def test_a_deck_instead_of_a_folder_is_refused(self):
        self.write("one.nml", SOUND)
        for folder, message in (("one.nml", "one.nml: not a folder"), ("none", "none: not a folder")):
            run = self.run_script("batch_parallel", folder, "out dir", status=1)
            self.assertEqual(run.stderr, f"batch_parallel.sh: {message}\n")

    def test_a_second_run_does_what_is_left(self):
        self.run_script("batch_parallel", "my decks", "out dir")
        before = os.stat(self.directory / "out dir" / "one.lst").st_mtime_ns
        self.write("my decks/another.nml", SOUND)
        self.run_script("batch_parallel", "my decks", "out dir")
        self.assertEqual(os.stat(self.directory / "out dir" / "one.lst").st_mtime_ns, before)
        self.assertIn("another.lst", self.results())

    @unittest.skipIf(shutil.which("parallel") is None, "GNU parallel is not installed")
    def test_failures_and_tally_are_printed(self):
        self.write("my decks/wrong.nml", "&mesh /\n")
        run = self.run_script("batch_parallel", "my decks", "out dir", status=1)
        self.assertEqual(run.stderr, "my decks/wrong.nml:1: &mesh needs size and cells\n")
        self.assertEqual(run.stdout, "3 decks: 2 solved, 1 refused\n")
        self.write("my decks/wrong.nml", SOUND)
        run = self.run_script("batch_parallel", "my decks", "out dir")
        self.assertEqual(run.stdout, "3 decks: 1 solved, 2 unchanged\n")
        with open(self.directory / "out dir" / "batch.csv", newline="", encoding="utf-8") as table:
            rows = {row["deck"]: row for row in csv.DictReader(table)}
        self.assertEqual({name: row["outcome"] for name, row in rows.items()},
                         {f"my decks/{name}.nml": "solved" for name in ("it's two", "one", "wrong")})

    def rows(self):
        """The rows of batch.csv by the names of their decks."""
        with open(self.directory / "out" / "batch.csv", newline="", encoding="utf-8") as table:
            return {row["deck"]: row for row in csv.DictReader(table)}

    def test_a_row_stands_for_the_files_of_its_case(self):
        for folder in ("a", "b"):
            (self.directory / folder).mkdir()
            self.write(f"{folder}/it's, one.nml", SOUND.replace("pressure = 1.0", f"pressure = 1.{ord(folder)}"))
        self.write("a/wrong.nml", "&mesh /\n")
        self.run_program("--skip-unchanged", "--output", "out", "a/it's, one.nml", "a/wrong.nml", status=1)
        run = self.run_program("--skip-unchanged", "--output", "out", "b/it's, one.nml")
        self.assertEqual(run.stderr, "\"a/it's, one.nml\": warning: its results were replaced by those of "
                         "'b/it's, one.nml', which has the same case name 'it's, one'; give each its own &case name\n")
        self.assertEqual([(deck, row["outcome"]) for deck, row in self.rows().items()],
                         [("a/wrong.nml", "refused"), ("b/it's, one.nml", "solved")])
        # Under another name it is the same deck, whose results are there.
        run = self.run_program("--skip-unchanged", "--output", "out", "b/../b/it's, one.nml")
        self.assertEqual((run.stdout, run.stderr), ("it's, one: unchanged, not solved again\n", ""))
        self.assertEqual(list(self.rows()), ["a/wrong.nml", "b/../b/it's, one.nml"])

    def test_only_results_that_are_there_are_replaced(self):
        # A deck that failed has none, and its row stays.
        failed = self.write("failed.nml", "&case name = 'x' /\n" + SOUND.replace("'top'", "'lid'"))
        renamed = self.write("renamed.nml", "&case name = 'x' /\n" + SOUND)
        other = self.write("other.nml", "&case name = 'x' /\n" + SOUND)
        self.run_program("--skip-unchanged", "--output", "out", failed, status=1)
        run = self.run_program("--skip-unchanged", "--output", "out", renamed)
        self.assertEqual(run.stderr, "")
        self.write("renamed.nml", "&case name = 'y' /\n" + SOUND)
        run = self.run_program("--output", "out", renamed, other)
        self.assertEqual(run.stderr, "")
        rows = self.rows()
        self.assertEqual([(row["case"], row["outcome"]) for row in rows.values()],
                         [("x", "refused"), ("y", "solved"), ("x", "solved")])
        self.assertIn("no set 'lid'", rows["failed.nml"]["message"])

    def test_an_unchanged_deck_without_a_row_gets_its_numbers(self):
        self.write("one.nml", SOUND)
        self.write("swept.nml", SOUND.replace("&load ", "&load name = 'p'  ") +
                   "&sweep load = 'p'  factor = 1.0, 2.0 /\n")
        self.run_program("--output", "out", "one.nml", "swept.nml")
        first = self.rows()
        (self.directory / "out" / "batch.csv").unlink()
        self.run_program("--skip-unchanged", "--output", "out", "one.nml", "swept.nml")
        for deck, row in self.rows().items():
            self.assertEqual({**row, "seconds": ""}, {**first[deck], "seconds": ""})

    def hostile_folder(self):
        """A folder whose name, and whose deck's name, a careless script would run or take for options."""
        folder = "-n; touch pwned; $(touch pwned) `touch pwned` \n\"' & {} * \\"
        deck = "-x; touch pwned; $(touch pwned) `touch pwned` \"' & {} * \\"
        (self.directory / folder).mkdir()
        self.write(f"{folder}/{deck}.nml", SOUND)
        return folder, deck

    @unittest.skipIf(shutil.which("parallel") is None, "GNU parallel is not installed")
    def test_names_are_never_run_by_parallel(self):
        folder, deck = self.hostile_folder()
        self.run_script("batch_parallel", folder, folder + "out", "--quiet")
        self.assertEqual(sorted(path.name for path in (self.directory / (folder + "out")).iterdir() if path.is_file()),
                         sorted(["batch.csv"] + results_of(deck)))
        self.assertFalse([name for name in self.files() if Path(name).name == "pwned"])

    def test_names_are_never_run_by_slurm(self):
        folder, deck = self.hostile_folder()
        self.run_script("batch_slurm", folder, folder + "out", "--quiet", SLURM_ARRAY_TASK_ID=1)
        self.assertEqual(sorted(path.name for path in (self.directory / (folder + "out")).iterdir()),
                         sorted(results_of(deck)))
        self.assertFalse([name for name in self.files() if Path(name).name == "pwned"])

    def test_options_are_never_run(self):
        for script, option in (("table1", "--method"), ("table1", "--variant"), ("table1", "--element"),
                               ("verify", None), ("setup", None)):
            for value in ("x/e; touch pwned;", "x'/; 1e touch pwned", "$(touch pwned)", "`touch pwned`"):
                with self.subTest(script=script, option=option, value=value):
                    run = self.run_script(script, *filter(None, [option]), value, status=None)
                    self.assertIn(run.returncode, (1, 2))
                    self.assertIn(value, run.stderr)
        self.assertFalse([path for path in (self.directory, SCRIPTS, SCRIPTS.parent) if (path / "pwned").exists()])

    def test_a_task_of_an_array_solves_its_deck(self):
        self.run_script("batch_slurm", "my decks", "out dir", "--quiet", SLURM_ARRAY_TASK_ID=2)
        self.assertEqual(self.results(), results_of("one"))
        self.assertIn("no deck 3 of 2", self.run_script("batch_slurm", "my decks", "out dir", SLURM_ARRAY_TASK_ID=3,
                                                        status=1).stderr)

    def test_a_task_of_several_ranks_is_launched_on_them(self):
        launcher = Path(self.write("mpiexec", '#!/bin/sh\necho "$1 $2" >launched\nshift 2\nexec "$@"\n'))
        (self.directory / launcher).chmod(0o755)
        path = f"{self.directory}:{os.environ['PATH']}"
        for ranks, launched in ((1, False), (3, True)):
            self.run_script("batch_slurm", "my decks", "out dir", "--quiet", SLURM_ARRAY_TASK_ID=2, SLURM_NTASKS=ranks,
                            PATH=path)
            self.assertEqual((self.directory / "launched").exists(), launched)
        self.assertEqual((self.directory / "launched").read_text(encoding="utf-8"), "-n 3\n")
        self.assertEqual(self.results(), results_of("one"))
        # Another launcher, whose ranks are not bound to one core either.
        self.write("srun", '#!/bin/sh\necho "$1 $2 $OMPI_MCA_hwloc_base_binding_policy" >launched\n'
                           'shift 2\nexec "$@"\n')
        (self.directory / "srun").chmod(0o755)
        self.run_script("batch_slurm", "my decks", "out dir", "--quiet", SLURM_ARRAY_TASK_ID=2, SLURM_NTASKS=2,
                        PATH=path, LAUNCHER="srun --mpi=pmix --exclusive")
        self.assertEqual((self.directory / "launched").read_text(encoding="utf-8"), "--mpi=pmix --exclusive none\n")


if __name__ == "__main__":
    unittest.main()
