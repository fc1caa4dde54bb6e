#!/usr/bin/env python3
"""Sweeps that are interrupted, killed, spoiled or run twice: nothing that was done is lost, nothing wrong is kept."""
import random
import re
import signal
import time
import unittest

from harness import CAN_MOUNT, PROGRAM
from test_sweep import SweepTest, map_of_states
from verification import checksum


class Interruption(SweepTest):
    """A sweep that ends before its time goes on where it was."""
    ANEW = b"all cases were solved again"

    def setUp(self):
        super().setUp()
        self.random = random.Random(1988)

    def start(self, *arguments, **streams):
        """Starts the program and does not wait for it."""
        return self.start_command([PROGRAM, *arguments], **streams)

    def test_killed_at_any_moment_no_byte_is_lost(self):
        self.write("sweep.nml", map_of_states(40))
        begin = time.monotonic()
        self.run_program("--quiet", "--output", "reference", "sweep.nml")
        duration = time.monotonic() - begin
        n_killed = n_resumed = 0
        # Until some went on where others had been killed, however fast the machine is from one run to the next.
        while n_killed < 100 or n_resumed == 0:
            done = 0
            while not (self.directory / "sweep.sweep.csv").exists():
                run = self.start("--quiet", "--threads", str(1 + n_killed % 2), "sweep.nml")
                time.sleep(duration*10.0**self.random.uniform(-2.0, 0.0))
                noted = self.n_done()
                run.kill()
                run.communicate()
                n_killed += run.returncode == -signal.SIGKILL
                if (self.directory / "sweep.sweep.csv").exists():
                    break
                # What was noted before the kill is still there, and what was noted before that.
                self.assertGreaterEqual(self.n_done(), max(noted, done))
                n_resumed += self.n_done() > done > 0
                done = self.n_done()
                if n_killed >= 100 and n_resumed > 0:
                    break
            self.run_program("--quiet", "sweep.nml")
            self.assertEqual(self.contents()["sweep.sweep.csv"], self.contents("reference")["sweep.sweep.csv"])
            self.assertEqual([name for name in self.contents() if name.endswith((".part", ".checkpoint"))], [])
            found, expected = self.summary(), self.summary(directory="reference")
            for member in ("iterations", "residual", "extremes", "certificate", "quantities"):
                self.assertEqual(found[member], expected[member])
            (self.directory / "sweep.sweep.csv").unlink()

    def test_spoiled_checkpoint_is_never_believed(self):
        self.write("sweep.nml", map_of_states(6))
        self.run_program("--quiet", "--output", "reference", "sweep.nml")
        expected = self.contents("reference")["sweep.sweep.csv"]
        names = ("sweep.sweep.checkpoint", "sweep.sweep.part")
        sound = None
        while sound is None or self.n_done() == 0:
            run = self.start("--quiet", "--threads", "1", "sweep.nml")
            self.wait_for_rows(run, 1)
            run.kill()
            run.communicate()
            sound = {name: content for name, content in self.contents().items() if name in names}
            if len(sound) < 2:
                sound = None
        for i in range(60):
            name = names[i % 2]
            content = bytearray(sound[name])
            at = self.random.randrange(len(content))
            match i//2 % 8:
                case 0 | 1 | 2:
                    content[at] ^= 1 << self.random.randrange(8)
                case 3:
                    del content[at:]
                case 4:
                    content[at:at] = content[self.random.randrange(len(content)):]
                case 5:
                    lines = content.splitlines(keepends=True)
                    lines.pop(self.random.randrange(len(lines)))
                    content = b"".join(lines)
                case 6:
                    content = bytearray(sound[names[1 - i % 2]])
                case 7:
                    # A line that counts too much.
                    content += content.splitlines(keepends=True)[-1].replace(b"1", b"7")
            for other in names:
                (self.directory / other).write_bytes(content if other == name else sound[other])
            with self.subTest(i=i, name=name):
                self.run_program("--quiet", "sweep.nml")
                self.assertEqual(self.contents()["sweep.sweep.csv"], expected)
            (self.directory / "sweep.sweep.csv").unlink()
        for name in names:
            (self.directory / name).mkdir()
            run = self.run_program("sweep.nml", status=3)
            self.assertRegex(run.stderr, rf"^sweep\.nml: \./{name}: cannot write this file: ")
            (self.directory / name).rmdir()

    def test_two_runs_of_one_sweep_do_not_mix(self):
        self.write("sweep.nml", map_of_states(20000))
        first = self.start("--quiet", "sweep.nml")
        self.wait_for_rows(first, 1)
        run = self.run_program("--quiet", "sweep.nml", status=1)
        self.assertEqual(run.stderr, "sweep.nml: ./sweep.sweep.checkpoint: another run is writing this file; wait "
                                     "until it ends, or choose another directory with --output\n")
        self.assertIsNone(first.poll())
        # The lock dies with its owner, who has no time to say goodbye.
        first.kill()
        first.communicate()
        done = self.n_done()
        second = self.start("--quiet", "sweep.nml")
        self.wait_for_rows(second, done + 1)
        second.terminate()
        second.communicate()
        self.assertEqual(second.returncode, 5)
        self.assertGreater(self.n_done(), done)

    def test_runs_that_begin_together_leave_one_whole_table(self):
        self.write("sweep.nml", map_of_states(6))
        self.run_program("--quiet", "--output", "reference", "sweep.nml")
        for _ in range(10):
            runs = [self.start("--quiet", "--threads", "1", "sweep.nml") for _ in range(3)]
            for run in runs:
                run.communicate()
            self.assertIn(0, [run.returncode for run in runs])
            self.assertLessEqual({run.returncode for run in runs}, {0, 1})
            self.assertEqual(self.contents()["sweep.sweep.csv"], self.contents("reference")["sweep.sweep.csv"])
            self.assertEqual([name for name in self.contents() if name.endswith((".part", ".checkpoint"))], [])
            (self.directory / "sweep.sweep.csv").unlink()

    def test_torn_files_are_cut_to_the_last_batch(self):
        self.write("sweep.nml", map_of_states(20000))
        run = self.start("--quiet", "sweep.nml")
        self.wait_for_rows(run, 1000)
        run.kill()
        run.communicate()
        done = self.n_done()
        for name in ("sweep.sweep.part", "sweep.sweep.checkpoint"):
            with open(self.directory / name, "ab") as file:
                file.write(b"12345 torn")
        run = self.start("--quiet", "sweep.nml")
        self.wait_for_rows(run, done + 1)
        run.send_signal(signal.SIGINT)
        self.assertEqual(run.wait(), 5)
        rows = self.contents()["sweep.sweep.part"].decode().splitlines()
        self.assertEqual([row.split(",")[0] for row in rows], ["case"] + [str(i + 1) for i in range(self.n_done())])

    def test_signals_stop_after_the_cases_under_way(self):
        self.write("sweep.nml", map_of_states(20000))
        done = 0
        for number in (signal.SIGINT, signal.SIGTERM):
            run = self.start("--quiet", "sweep.nml", "never_tried.nml")
            self.wait_for_rows(run, done + 1)
            run.send_signal(number)
            _, message = run.communicate()
            self.assertEqual(run.returncode, 5)
            self.assertGreater(self.n_done(), done)
            done = self.n_done()
            self.assertEqual(message, f"sweep.nml: interrupted after {done} of 4000000 cases; the same command goes on "
                                      "from there\n")
            self.assertEqual(sorted(self.contents()),
                             ["batch.csv", "sweep.nml", "sweep.sweep.checkpoint", "sweep.sweep.part"])

    def test_changed_deck_begins_anew(self):
        self.write("sweep.nml", map_of_states(20000))
        run = self.start("--quiet", "sweep.nml")
        self.wait_for_rows(run, 500)
        run.terminate()
        run.communicate()
        text = map_of_states(3).replace("poisson = 0.25", "poisson = 0.3")
        self.run_program("--quiet", "--output", "fresh", self.write("sweep.nml", text))
        self.run_program("--quiet", "sweep.nml")
        self.assertEqual(self.contents()["sweep.sweep.csv"], self.contents("fresh")["sweep.sweep.csv"])
        self.assertEqual(self.summary()["sweep"]["done_earlier"], 0)
        self.assertIn(self.ANEW, self.contents()["sweep.lst"])
        self.assertNotIn(self.ANEW, self.contents("fresh")["sweep.lst"])

    def test_checkpoint_of_another_form_begins_anew(self):
        # As an earlier version wrote it: sums of another kind.
        self.write("sweep.nml", map_of_states(6))
        self.run_program("--quiet", "--output", "fresh", "sweep.nml")
        while self.n_done() == 0:
            run = self.start("--quiet", "--threads", "1", "sweep.nml")
            self.wait_for_rows(run, 1)
            run.kill()
            run.communicate()
        path = self.directory / "sweep.sweep.checkpoint"
        path.write_bytes(re.sub(rb" \d+ \d+ rows", b" %s %s rows" % (b"000006c5d716d144"*2, b"0070706d7956afd5"*2),
                                path.read_bytes()))
        self.run_program("--quiet", "sweep.nml")
        self.assertIn(self.ANEW, self.contents()["sweep.lst"])
        self.assertEqual(self.summary()["sweep"]["done_earlier"], 0)
        self.assertEqual(self.contents()["sweep.sweep.csv"], self.contents("fresh")["sweep.sweep.csv"])

    def test_checksums_of_the_checkpoint_are_those_of_its_texts(self):
        self.write("sweep.nml", map_of_states(20000))
        run = self.start("--quiet", "sweep.nml")
        self.wait_for_rows(run, 1000)
        run.kill()
        run.communicate()
        table = self.contents()["sweep.sweep.part"]
        lines = [line for line in self.contents()["sweep.sweep.checkpoint"].splitlines() if line.endswith(b" rows")]
        self.assertTrue(lines)
        for line in lines:
            noted, own = line.decode().split()[-3:-1]
            self.assertEqual(int(noted), checksum(table[:int(line.split()[0])]))
            self.assertEqual(int(own), checksum(line[:-len(f" {own} rows")]))

    def test_changed_table_of_friction_begins_anew(self):
        deck = map_of_states(100).replace("friction = 0.3", "friction_table = 'friction.txt'")
        self.write("sweep.nml", deck.replace("sweep friction =", "sweep friction_factor ="))
        self.write("friction.txt", "0.0 0.1\n4.0 0.5\n")
        run = self.start("--quiet", "sweep.nml")
        self.wait_for_rows(run, 1)
        run.kill()
        run.communicate()
        self.write("friction.txt", "0.0 0.1\n4.0 0.6\n")
        self.run_program("--quiet", "sweep.nml")
        self.run_program("--quiet", "--output", "fresh", "sweep.nml")
        self.assertEqual(self.contents()["sweep.sweep.csv"], self.contents("fresh")["sweep.sweep.csv"])
        self.assertEqual(self.summary()["sweep"]["done_earlier"], 0)

    def test_full_disk_is_told_and_nothing_final_is_written(self):
        self.write("sweep.nml", map_of_states(3))
        run = self.run_command(["prlimit", "--fsize=10", PROGRAM, "sweep.nml"], 3)
        self.assertEqual(run.stderr, "sweep.nml: ./sweep.sweep.part: cannot write this file: File too large\n")
        self.assertNotIn("sweep.sweep.csv", self.contents())

    @unittest.skipUnless(CAN_MOUNT, "file systems cannot be mounted here")
    def test_sweep_goes_on_when_the_disk_has_room_again(self):
        self.write("sweep.nml", map_of_states(20))
        self.run_program("--quiet", "--output", "expected", "sweep.nml")
        (self.directory / "disk").mkdir()
        size = len(self.contents("expected")["sweep.sweep.csv"])
        run = self.run_command(["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", f"""
            mount -t tmpfs -o size={size//2} none disk || exit
            "$0" --quiet --output disk sweep.nml; echo $?; ls -A disk
            mount -o remount,size={4*size} disk || exit
            "$0" --quiet --output disk sweep.nml; echo $?; ls -A disk
            cp disk/sweep.sweep.csv disk/sweep.summary.json .""", PROGRAM])
        self.assertEqual(run.stderr, "sweep.nml: disk/sweep.sweep.part: cannot write this file: No space left on "
                                     "device\n")
        self.assertEqual(run.stdout.split(), ["3", "sweep.sweep.checkpoint", "sweep.sweep.part", "0", "sweep.deck.nml",
                                              "sweep.lst", "sweep.summary.json", "sweep.sweep.csv"])
        self.assertEqual(self.contents()["sweep.sweep.csv"], self.contents("expected")["sweep.sweep.csv"])
        self.assertGreater(self.summary()["sweep"]["done_earlier"], 0)

    def test_links_laid_out_beforehand_are_not_followed(self):
        self.write("sweep.nml", map_of_states(3))
        for name in ("sweep.sweep.part", "sweep.sweep.checkpoint"):
            (self.directory / name).symlink_to(self.write("victim", "precious"))
        self.run_program("--quiet", "sweep.nml")
        self.assertEqual(self.contents()["victim"], b"precious")


if __name__ == "__main__":
    unittest.main()
