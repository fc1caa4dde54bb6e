#!/usr/bin/env python3
"""What goes wrong after the deck was read: exit status, message, and that no older result is harmed."""
import itertools
import os
import random
import re
import shutil
import subprocess
import time
import unittest

from harness import (CAN_MOUNT, CONTACT, HAS_OPENBLAS, HAS_SANITIZER, PRESSURE, PROGRAM, SOUND, SUPPORT, ProgramTest,
                     block, results_of)

SLOW = block(SUPPORT, "load set = 'top'  pressure = 3.0", CONTACT, "solver method = 'psor'  max_iterations = 2")
LIFTED = block(SUPPORT, CONTACT, "load set = 'top'  traction = 0.0, 1.0")


class NumericalFailure(ProgramTest):
    """Status 2: the deck is in order, the numbers are not; nothing is written."""

    def assert_failure(self, text, message):
        self.write("failed.nml", text)
        run = self.run_program("--output", "results", "failed.nml", status=2)
        self.assertEqual(run.stdout, "")
        self.assertEqual(run.stderr, f"failed.nml: {message}")
        self.assertEqual(self.files(), ["failed.nml"])

    def test_stiffness_out_of_range(self):
        # Areas of 1e400 are infinite.
        self.assert_failure(block(SUPPORT, PRESSURE, CONTACT, mesh="size = 1e200, 1e200  cells = 8, 4"),
                            "the stiffness leaves the range of double precision (1.8e308): choose units that make "
                            "lengths and moduli smaller\n")

    def test_displacements_out_of_range(self):
        self.assert_failure(block(SUPPORT, CONTACT, "load set = 'top'  pressure = 1e300",
                                  material="young = 1e-300  poisson = 0.25"),
                            "displacements, forces or energies leave the range of double precision (1.8e308): choose "
                            "other units\n")
        # A method that squares the displacements leaves it first.
        self.assert_failure(block("support set = 'left'  ux = 0.0  uy = 0.0", CONTACT,
                                  "load set = 'top'  pressure = 1e180", "solver method = 'psor'",
                                  material="young = 1e-150  poisson = 0.25"),
                            "floating-point overflow in the contact method: check the units of stiffness, load and "
                            "friction\n")


class WrongSolution(ProgramTest):
    """Status 4: a solution that does not pass its certificate is written, and said to be wrong."""

    def test_displacements_that_swallow_the_deformation(self):
        # Beside a displacement of 1e12 the deformations are lost in its rounding, 1e-4.
        deck = block("support set = 'left'  ux = 1e12  uy = 1e12", PRESSURE + "  name = 'press'", CONTACT)
        for more in ("", "&sweep load = 'press'  factor = 1.0, 2.0 /\n"):
            run = self.run_program(self.write("case.nml", deck + more), status=4)
            self.assertRegex(run.stderr, r"^case\.nml: the certificate FAILED: largest violation 0\.\d+, limit \S+; "
                             "see the listing\n$")
            self.assertRegex((self.directory / "case.lst").read_text(encoding="utf-8"), r"\n  Verdict +FAILED: ")
            summary = (self.directory / "case.summary.json").read_text(encoding="utf-8")
            self.assertIn('"passed": false', summary)
            self.assertIn('"outcome": "not_certified",\n  "converged": true', summary)


@unittest.skipIf(HAS_SANITIZER, "this build takes more addresses than any limit allows")
class LittleMemory(ProgramTest):
    """Status 3: a limit of addresses leaves no room; the program says so, and does not wait for room."""

    def run_limited(self, limit, n_threads, *study):
        """Runs a study of a strip with 6 002 contact unknowns, a case unless given, under a limit [kB]."""
        self.write("strip.nml", block("load set = 'top'  traction = 0.1, -1.0  name = 'push'", CONTACT,
                                      "solver method = 'fixed_point'  max_iterations = 3", *study,
                                      mesh="size = 300.0, 1.0  cells = 3000, 2"))
        # OpenBLAS takes memory for its own threads before the program begins.
        limited = f'ulimit -v {limit}; OMP_NUM_THREADS={n_threads} exec "$@"'
        return self.run_command(["bash", "-c", limited, "bash", PROGRAM, "--output", "out", "strip.nml"], 3)

    def test_matrix_of_a_case_a_row_or_a_step(self):
        told = r"not enough memory: a dense matrix of the contact points, 6002 by 6002 numbers, needs 288 MB"
        for study, before, behind in (
                ((), "", ""), (("sweep load = 'push'  factor = 1.0, 1.1",), "", ""),
                (("history times = 0.0, 1.0", "steps load = 'push'  factor = 1.0, 1.1"), r"step 1 \(to 0\.0\): ",
                 "; the history ends at step 0")):
            with self.subTest(study):
                run = self.run_limited(450000, 1, *study)
                self.assertRegex(run.stderr, rf"^strip\.nml: {before}{told}{behind}\n$")
                self.assertEqual(list(self.directory.glob("out/*")), [])

    def test_every_limit_is_too_little_in_a_sentence_or_enough(self):
        # A strip on the band matrix of its contact points: its own arrays are as large as its factor.
        self.write("strip.nml", block(SUPPORT, PRESSURE, CONTACT, mesh="size = 300.0, 1.0  cells = 3000, 2"))
        ended = []
        for limit in range(150000, 500000, 1000):
            run = self.run_command(["bash", "-c", f'ulimit -v {limit}; OMP_NUM_THREADS=1 exec "$@"', "bash", PROGRAM,
                                    "--quiet", "--output", "out", "strip.nml"], None)
            ended.append(run.returncode)
            if run.returncode == 0:
                break
            self.assertRegex(run.stderr, r"\A[^\n]*not enough memory: [^\n]*\n\Z", limit)
            self.assertEqual((run.returncode, list(self.directory.glob("out/*"))), (3, []), limit)
        self.assertEqual({*ended}, {0, 3})

    @unittest.skipUnless(HAS_OPENBLAS, "another BLAS takes no such memory")
    def test_threads_of_the_blas(self):
        needed = "amontons: not enough memory: the BLAS needs 128 MiB of addresses for each thread\n"
        for n_threads in (1, 2, 8):
            run = self.run_limited(100000, n_threads)
            self.assertEqual(run.stderr, needed)
            self.assertEqual(self.files(), ["strip.nml"])
            # Whether OpenBLAS takes its memory when it is loaded or later, it never waits for room that is not there.
            for limit in range(110000, 2000000, 10000):
                run = self.run_command(["bash", "-c", f'ulimit -v {limit}; OMP_NUM_THREADS={n_threads} exec "$@"',
                                        "bash", PROGRAM, "--version"], None)
                self.assertIn((run.returncode, run.stderr), {(0, ""), (3, needed)}, limit)
                if run.returncode == 0:
                    break
            self.assertEqual(run.returncode, 0)


class SystemFailure(ProgramTest):
    """Status 3: the files cannot be written."""

    def setUp(self):
        super().setUp()
        self.write("case.nml", SOUND)

    def assert_failure(self, output, message):
        before = self.files()
        run = self.run_program("--output", output, "case.nml", status=3)
        self.assertEqual(run.stdout, "")
        self.assertEqual(run.stderr, f"case.nml: {output}{message}\n")
        self.assertEqual(self.files(), before)

    def test_output_is_a_file(self):
        self.write("taken", "")
        self.assert_failure("taken", ": cannot make this directory: Not a directory")
        self.assert_failure("taken/results", ": cannot make this directory: Not a directory")
        self.assert_failure("/dev/null/results", ": cannot make this directory: Not a directory")

    def test_output_with_a_name_too_long(self):
        self.assert_failure("x"*300, ": cannot make this directory: File name too long")

    @unittest.skipIf(os.geteuid() == 0, "root may write everywhere")
    def test_output_that_is_read_only(self):
        (self.directory / "results").mkdir(0o555)
        self.assert_failure("results/more", ": cannot make this directory: Permission denied")
        run = self.run_program("--output", "results", "case.nml", status=3)
        self.assertTrue(run.stderr.startswith("case.nml: results/case.lst: cannot write this file: "), run.stderr)

    def test_directory_in_the_place_of_a_file(self):
        for name in results_of("case"):
            with self.subTest(name=name):
                (self.directory / "results" / name).mkdir(parents=True)
                run = self.run_program("--output", "results", "case.nml", status=3)
                self.assertEqual(run.stderr,
                                 f"case.nml: results/{name}: cannot put this file in place: Is a directory\n")
                self.assertEqual([file for file in self.files() if file.endswith(".tmp")], [])
                shutil.rmtree(self.directory / "results")

    def test_limit_on_file_sizes(self):
        self.run_program("case.nml")
        before = self.contents()
        for size in (0, 1, max(len(content) for content in before.values()) - 1):
            with self.subTest(size=size):
                # Leaks are not looked for: gfortran's library loses the buffer of a file that it cannot write.
                run = self.run_command(["env", "ASAN_OPTIONS=detect_leaks=0", "prlimit", f"--fsize={size}", PROGRAM,
                                        "case.nml"], 3)
                self.assertRegex(run.stderr, r"^case\.nml: \./case\.[a-z.]+: cannot write this file: ")
                self.assertEqual(self.contents(), before)

    def test_folders_that_stayed_empty_are_removed(self):
        for folder in ("new", "new/in/another"):
            run = self.run_command(["env", "ASAN_OPTIONS=detect_leaks=0", "prlimit", "--fsize=100", PROGRAM, "--output",
                                    folder, "case.nml"], 3)
            self.assertRegex(run.stderr, rf"^case\.nml: {folder}/case\.[a-z.]+: cannot write this file: ")
            self.assertFalse((self.directory / "new").exists())

    @unittest.skipUnless(CAN_MOUNT, "file systems cannot be mounted here")
    def test_full_disk(self):
        # A file system of a few pages is filled more and more, until the files no longer find room: each is the first
        # that fails once. A page holds 4096 bytes, and every file takes whole ones.
        self.write("case.nml", block(SUPPORT, PRESSURE, CONTACT, mesh="size = 4.0, 2.0  cells = 32, 16"))
        self.run_program("--output", "results", "case.nml")
        sizes = {name: len(content) for name, content in self.contents("results").items()}
        n_pages = sum(-(-size//4096) for size in sizes.values())
        (self.directory / "disk").mkdir()
        failed = set()
        for n_free in range(1, n_pages):
            run = self.run_command(["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", f"""
                mount -t tmpfs -o size={4*(n_free + 2)}k none disk || exit
                cp case.nml disk/old && cp case.nml disk/case.lst &&
                {{ ASAN_OPTIONS=detect_leaks=0 "$0" --output disk case.nml; status=$?; }}
                cmp case.nml disk/case.lst && ls -A disk && exit $status""", PROGRAM], 3)
            self.assertEqual(run.stdout, "case.lst\nold\n")
            match = re.match(r"case\.nml: disk/(case\.[a-z.]+): cannot write this file: ", run.stderr)
            self.assertTrue(match, run.stderr)
            failed.add(match[1])
        self.assertEqual(sorted(failed), results_of("case"))

    @unittest.skipUnless(CAN_MOUNT, "file systems cannot be mounted here")
    def test_disk_without_room_for_another_file(self):
        self.run_program("--output", "results", "case.nml")
        (self.directory / "disk").mkdir()
        # Its root and the older file are files as well.
        for n_free in range(len(results_of("case"))):
            run = self.run_command(["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", f"""
                mount -t tmpfs -o nr_inodes={n_free + 2} none disk || exit
                cp case.nml disk/case.lst && {{ "$0" --output disk case.nml; status=$?; }}
                cmp case.nml disk/case.lst && ls -A disk && exit $status""", PROGRAM], 3)
            self.assertEqual(run.stdout, "case.lst\n")
            self.assertRegex(run.stderr, r"^case\.nml: disk/case\.[a-z.]+: cannot write this file: No space left on ")

    @unittest.skipUnless(CAN_MOUNT, "file systems cannot be mounted here")
    def test_file_system_that_is_read_only(self):
        (self.directory / "disk").mkdir()
        for output, sentence in (("disk", "case.lst: cannot write this file"),
                                 ("disk/more", ": cannot make this directory")):
            run = self.run_command(["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", f"""
                mount -t tmpfs none disk && cp case.nml disk/case.lst && mount -o remount,ro disk || exit
                "$0" --output {output} case.nml; status=$?
                cmp case.nml disk/case.lst && ls -A disk && exit $status""", PROGRAM], 3)
            self.assertEqual(run.stdout, "case.lst\n")
            self.assertIn(sentence, run.stderr)
            self.assertIn("Read-only file system", run.stderr)

    def test_directory_that_vanishes(self):
        choice = random.Random(1736)
        self.write("case.nml", block(SUPPORT, PRESSURE, CONTACT, mesh="size = 4.0, 2.0  cells = 48, 24"))
        begin = time.monotonic()
        self.run_program("--output", "expected", "case.nml")
        duration = time.monotonic() - begin
        statuses = set()
        # Until both ends have been met, however fast the machine is from one run to the next.
        for i in itertools.count():
            if i >= 40 and statuses == {0, 3}:
                break
            results = self.directory / "results"
            results.mkdir(exist_ok=True)
            run = subprocess.Popen([PROGRAM, "--quiet", "--output", "results", "case.nml"], cwd=self.directory,
                                   stderr=subprocess.PIPE, encoding="utf-8")
            self.addCleanup(run.kill)
            while i % 4 and run.poll() is None and not os.listdir(results):
                time.sleep(0.0002)
            time.sleep(duration*10.0**choice.uniform(-3.0, 0.3))
            results.rename(self.directory / f"gone {i}")
            _, message = run.communicate(timeout=self.timeout)
            statuses.add(run.returncode)
            if run.returncode == 3:
                self.assertRegex(message, r"^case\.nml: results/[a-z.]*: cannot (write|put) this file")
                self.assertEqual(self.contents(f"gone {i}").keys() & set(results_of("case")), set())
            else:
                self.assertEqual((run.returncode, message), (0, ""))
                places = [place for place in ("results", f"gone {i}") if (self.directory / place).exists()]
                self.assertIn(results_of("case"), [sorted(self.contents(place)) for place in places])
            shutil.rmtree(results, ignore_errors=True)
        self.assertEqual(statuses, {0, 3})

    def test_links_laid_out_beforehand_are_not_followed(self):
        self.write("victim", "precious")
        process = subprocess.Popen(["sh", "-c", 'read go; exec "$0" --quiet case.nml', PROGRAM], cwd=self.directory,
                                   stdin=subprocess.PIPE)
        for name in results_of("case"):
            (self.directory / name).symlink_to("victim")
            (self.directory / f"{name}.{process.pid}.tmp").symlink_to("victim")
        process.communicate(b"go\n")
        self.assertEqual(process.returncode, 0)
        self.assertEqual(self.contents()["victim"], b"precious")
        for name in results_of("case"):
            self.assertFalse((self.directory / name).is_symlink())


class StandardOutput(ProgramTest):
    """Status 3 where standard output takes no more; the files are whole all the same."""

    def setUp(self):
        super().setUp()
        self.write("case.nml", SOUND)
        self.write("other.nml", SOUND)

    def run_shell(self, script, status):
        return self.run_command(["bash", "-c", script, PROGRAM], status)

    @unittest.skipUnless(os.path.exists("/dev/full"), "there is no /dev/full")
    def test_full(self):
        run = self.run_shell('"$0" case.nml other.nml > /dev/full', 3)
        reason = ": standard output: cannot write: No space left on device\n"
        self.assertEqual(run.stderr, f"case.nml{reason}other.nml{reason}")
        self.assertEqual(self.files(), sorted(["batch.csv", "case.nml", "other.nml", "cases.pvd", *results_of("case"),
                                               *results_of("other")]))
        for option in ("--help", "--version"):
            self.assertEqual(self.run_shell(f'"$0" {option} > /dev/full', 3).stderr, reason[2:])
        self.assertEqual(self.run_shell('"$0" --check case.nml > /dev/full', 3).stderr, "case.nml" + reason)
        self.run_shell('"$0" --quiet case.nml > /dev/full', 0)

    def test_closed_pipe(self):
        # The reader is gone before the program starts.
        reader, writer = os.pipe()
        os.close(reader)
        with os.fdopen(writer, "wb") as pipe:
            run = subprocess.run([PROGRAM, "case.nml"], cwd=self.directory, stdout=pipe, stderr=subprocess.PIPE,
                                 encoding="utf-8", timeout=self.timeout, check=False)
        self.assertEqual((run.returncode, run.stderr), (3, "case.nml: standard output: cannot write: Broken pipe\n"))
        self.assertEqual(self.files(), sorted(["case.nml", "other.nml", *results_of("case")]))

    def test_closed(self):
        run = self.run_shell('"$0" case.nml >&-', 3)
        self.assertEqual(run.stderr, "case.nml: standard output: cannot write: Bad file descriptor\n")
        self.run_shell('"$0" --output expected case.nml', 0)
        for name in ("case.lst", "case.contact.csv", "case.vtu", "case.deck.nml"):
            if name != "case.lst":  # it tells the time
                self.assertEqual(self.contents()[name], self.contents("expected")[name])
        self.run_shell('"$0" --quiet case.nml <&- >&- 2>&-', 0)

    def test_deaf_standard_error_changes_no_status(self):
        self.write("refused.nml", "&mesh /")
        for to in (">/dev/full", ">&-"):
            self.run_shell(f'"$0" refused.nml 2{to}', 1)
            self.run_shell(f'"$0" --nonsense 2{to}', 1)

    def test_not_converged_is_worse(self):
        self.write("slow.nml", SLOW)
        self.run_shell('"$0" slow.nml >&-', 4)


class NotConverged(ProgramTest):
    """Status 4: the files are written and say so."""

    def test_tolerance_below_rounding_is_named(self):
        # No sum of ten thousand rounded products vanishes to the last bit at all of 18 points.
        run = self.run_program(self.write("strict.nml", block(
            "load set = 'top'  pressure = 1.1", "load set = 'left'  traction = 0.37, 0.0",
            "contact set = 'bottom'  friction = 0.31  obstacle = 'circle'  point = 2.0, 0.0  normal = 0.0, 1.0"
            "  radius = 77.0", "solver tolerance = 1e-18", mesh="size = 4.0, 2.0  cells = 17, 9",
            material="young = 97.3  poisson = 0.29")), status=4)
        self.assertRegex(run.stderr, r"^strict\.nml: not converged: residual \S+, tolerance 1\.0e-18, which is below "
                                     r"rounding \(about 1\.0e-14\)\n$")

    def test_files_are_written_and_marked(self):
        run = self.run_program(self.write("slow.nml", SLOW), status=4)
        self.assertRegex(run.stderr, r"^slow\.nml: not converged: residual [\d.]+, tolerance 1\.0e-10\n$")
        self.assertTrue(run.stdout.startswith("slow: NOT CONVERGED, 2 iterations, residual "), run.stdout)
        self.assertEqual(self.files(), sorted(["slow.nml", *results_of("slow")]))
        summary = self.result("slow").summary
        self.assertIs(summary["converged"], False)
        self.assertEqual(summary["iterations"], 2)
        self.assertGreater(summary["residual"], 1e-10)
        self.assertIs(summary["certificate"]["passed"], False)
        listing = self.contents()["slow.lst"].decode()
        self.assertIn("NO: stopped after 2 iterations; the results below are not the solution\n", listing)


class SeveralDecks(ProgramTest):
    """Every deck is tried; the largest status counts."""

    def setUp(self):
        super().setUp()
        self.write("sound.nml", SOUND)
        self.write("slow.nml", SLOW)
        self.write("lifted.nml", LIFTED)
        self.write("refused.nml", "&mesh /")
        self.write("other.nml", SOUND.replace("pressure = 1.0", "pressure = 1.5"))

    def test_the_largest_status_counts(self):
        decks = ["sound.nml", "refused.nml", "lifted.nml", "slow.nml"]
        for last, status in enumerate((0, 1, 2, 4)):
            run = self.run_program("--quiet", "--output", "results", *reversed(decks[:last + 1]), status=status)
            self.assertEqual(run.stderr.count("\n"), last, run.stderr)

    def test_system_failure_is_worse_than_bad_input(self):
        self.run_program("--output", "sound.nml", "sound.nml", "refused.nml", status=3)

    def test_every_deck_is_tried(self):
        decks = ["refused.nml", "sound.nml", "lifted.nml", "slow.nml", "none.nml", "other.nml"]
        run = self.run_program("--output", "results", *decks, status=4)
        self.assertEqual([line.split(":")[0] for line in run.stdout.splitlines()], ["sound", "slow", "other",
                                                                                     "6 decks"])
        self.assertEqual([line.split(":")[0] for line in run.stderr.splitlines()],
                         ["refused.nml", "lifted.nml", "slow.nml", "none.nml"])
        self.assertEqual(sorted(self.contents("results")),
                         sorted(["batch.csv", "cases.pvd", "lifted.deck.nml", "lifted.lst", "lifted.summary.json"]
                                + results_of("sound") + results_of("slow") + results_of("other")))

    def test_deck_behind_a_failed_one_is_solved_as_alone(self):
        self.write("tpo.nml", SOUND.replace("'left'", "'tpo'"))
        self.run_program("sound.nml", "tpo.nml", "other.nml", status=1)
        behind = self.result("other")
        self.run_program("--output", "alone", "other.nml")
        self.assertEqual(behind.columns, self.result("other", "alone").columns)

    def test_case_names_must_differ(self):
        self.write("twin.nml", SOUND.replace("pressure = 1.0", "pressure = 1.5") + "&case name = 'sound' /\n")
        for check in ([], ["--check"]):
            run = self.run_program(*check, "sound.nml", "twin.nml", "other.nml", status=1)
            self.assertEqual(run.stderr, "twin.nml: an earlier deck of this run has the case name 'sound' too; "
                             "give each its own &case name\n")
            self.assertEqual(run.stdout.count("\n"), 3)
            self.assertTrue(run.stdout.endswith(f"3 decks: 2 {'OK' if check else 'solved'}, 1 refused\n"), run.stdout)
        self.assertAlmostEqual(self.result("sound").summary["resultants"]["normal_force"], 4.0)

    def test_cases_that_would_share_a_grid_are_refused(self):
        self.write("sound.contact.nml", SOUND)
        for decks in (["sound.nml", "sound.contact.nml"], ["sound.contact.nml", "sound.nml"]):
            for check in ([], ["--check"]):
                run = self.run_program(*check, "--output", "results", *decks, "other.nml", status=1)
                first, second = (deck[:-4] for deck in decks)
                self.assertEqual(run.stderr, f"{second}.nml: an earlier deck of this run, with the case name "
                                 f"'{first}', leaves a file 'sound.contact.vtu' as the case '{second}' does; "
                                 "give this one another &case name\n")
                self.assertEqual([line.split(":")[0] for line in run.stdout.splitlines()], [first, "other", "3 decks"])
            self.run_program("--verify", "results")
            shutil.rmtree(self.directory/"results")

    def test_cases_that_share_no_file_may_have_such_names(self):
        # A sweep leaves no NAME.vtu.
        self.write("sound.contact.nml", SOUND + "&sweep friction = 0.3, 0.4 /")
        self.run_program("--output", "results", "sound.nml", "sound.contact.nml")
        for name in ("sound.sweep", "sound.reduced", "sound.deck", "sound.summary", "sound.contact.contact"):
            self.write(f"{name}.nml", SOUND)
            self.run_program("--output", "others", "sound.nml", f"{name}.nml")
            self.run_program("--verify", "others")

    def test_the_same_deck_twice_is_refused(self):
        run = self.run_program("sound.nml", "./sound.nml", status=1)
        self.assertTrue(run.stderr.startswith("./sound.nml: an earlier deck "), run.stderr)


class OlderResults(ProgramTest):
    """A failed run leaves the results of the run before as they are."""

    def test_older_results_are_untouched(self):
        self.write("case.nml", SOUND)
        self.run_program("--output", "results", "case.nml")
        before = self.contents("results")
        self.assertEqual(sorted(before), results_of("case"))
        for text, status in (("&mesh /", 1), (SOUND + "&load set = 'tpo'  pressure = 1.0 /", 1),
                             (block(SUPPORT, PRESSURE, CONTACT, mesh="size = 1e200, 1e200  cells = 8, 4"), 2)):
            self.run_program("--output", "results", self.write("case.nml", text), status=status)
            self.assertEqual(self.contents("results"), before)

    def test_results_are_replaced_by_those_of_the_next_run(self):
        for pressure in ("1.0", "2.5"):
            self.solve(SOUND.replace("pressure = 1.0", f"pressure = {pressure}"))
            self.assertAlmostEqual(self.result("case").summary["resultants"]["normal_force"], 4*float(pressure))
        self.assertEqual(self.files(), sorted(["case.nml", *results_of("case")]))


if __name__ == "__main__":
    unittest.main()
