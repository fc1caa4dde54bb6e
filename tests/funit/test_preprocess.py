#!/usr/bin/env python3
"""Unit tests of funit_preprocess.py, run as the program it is.

The tests that compile what it makes need the environment variables FC (the compiler) and FUNIT_MODULES (the directory
of the module files of funit).
"""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PREPROCESSOR = Path(__file__).with_name("funit_preprocess.py")
GOOD = """\
module test_demo
   use funit
   implicit none
   integer :: counter = 0
contains
   @before
   subroutine prepare()
      counter = counter + 1
   end subroutine prepare

   @test
   ! A comment and a blank line may stand here.

   subroutine first()
      @assertEqual([1, 2], [(counter, counter=1, 2)], message='a, b) and ''c''')
   end subroutine first

   @Test(ifdef=DEMO)
   @disable
   Subroutine second
      @AssertTrue(.true., message="it's")
   end subroutine second
end module test_demo
"""
ASSERT_LINE = 15
ASSERTION = "@assertEqual([1, 2], [(counter, counter=1, 2)], message='a, b) and ''c''')"


class Case(unittest.TestCase):
    """A temporary directory with a .pf file in it."""

    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = Path(directory.name)
        self.output = self.directory / "out.F90"

    def preprocess(self, text, name="test_demo"):
        """Runs the preprocessor on the text."""
        self.source = self.directory / f"{name}.pf"
        self.source.write_text(text, encoding="utf-8")
        return subprocess.run([sys.executable, PREPROCESSOR, self.source, self.output],
                              capture_output=True, text=True, check=False)

    def edit(self, old, new, line):
        """The good file with one piece of text replaced, and a check of where that is."""
        self.assertEqual(GOOD.count(old), 1, old)
        self.assertEqual(GOOD[:GOOD.index(old)].count("\n") + 1, line, old)
        return GOOD.replace(old, new)


class Refusals(Case):
    """What is outside the subset is refused at its line, and nothing is written."""

    def refuse(self, text, line, message, name="test_demo"):
        run = self.preprocess(text, name)
        self.assertEqual(run.returncode, 1, run.stderr)
        self.assertTrue(run.stderr.startswith(f"{self.source}:{line}: error: "), run.stderr)
        self.assertIn(message, run.stderr)
        self.assertEqual(run.stderr.count("\n"), 1)
        self.assertFalse(self.output.exists())

    def refuse_assertion(self, assertion, message):
        self.refuse(self.edit(ASSERTION, assertion, ASSERT_LINE), ASSERT_LINE, message)

    def test_unknown_directive(self):
        self.refuse_assertion("@assertSame(1, 1)", "@assertSame is no directive")
        self.refuse_assertion("@ assertTrue(.true.)", "@ is no directive")

    def test_directives_outside_the_subset(self):
        for name in ("suite(name='x')", "testCase", "testParameter", "mpiTest(npes=[1])"):
            self.refuse(self.edit("@before", "@" + name, 6), 6, f"@{name.split('(')[0]} is no directive")

    def test_trailing_text(self):
        for tail in (" ! note (x)", "; counter = 2", " &", "(1)"):
            self.refuse_assertion("@assertTrue(.true.)" + tail, "nothing after it")
        self.refuse(self.edit("@before", "@before ! note", 6), 6, "@before has nothing after it")
        self.refuse(self.edit("@disable", "@disable()", 19), 19, "@disable has nothing after it")
        self.refuse(self.edit("@test\n", "@test(npes=[1])\n", 11), 11, "@test has nothing after it")
        self.refuse(self.edit("@test\n", "@test(ifdef=1)\n", 11), 11, "(ifdef=NAME)")

    def test_comment_or_continuation_inside(self):
        for inside in ("@assertTrue(.true. ! note", "@assertTrue(&", "@assertTrue(.true.; .true.)"):
            self.refuse_assertion(inside, "whole on its line")

    def test_unbalanced_parentheses(self):
        for text in ("@assertTrue((.true.)", "@assertTrue([.true.)", "@assertTrue(.true.])", "@assertTrue("):
            self.refuse_assertion(text, "unbalanced parentheses")
        self.refuse_assertion("@assertTrue(.true., message='a)", "unbalanced quotes")

    def test_missing_parentheses(self):
        for text in ("@assertTrue", "@assertTrue (.true.)", "@assertTrue .true."):
            self.refuse_assertion(text, "expected '('")

    def test_long_line(self):
        frame = "@assertTrue(.true., message='')"
        longest = frame.replace("''", "'" + "m" * (120 - 6 - len(frame)) + "'")
        self.refuse_assertion(longest.replace("m'", "mm'"), "column 120")
        self.assertEqual(self.preprocess(GOOD.replace(ASSERTION, longest)).returncode, 0)

    def test_test_without_plain_subroutine(self):
        for other in ("recursive subroutine first()", "pure subroutine first()", "subroutine first(this)",
                      "subroutine first() ! note", "integer function first()", "@before", "@test",
                      "@assertTrue(.true.)", "#ifdef DEMO"):
            self.refuse(self.edit("subroutine first()", other, 14), 14, "expected 'subroutine name()' after @test")

    def test_test_at_the_end_of_the_file(self):
        self.refuse(GOOD + "@test\n", GOOD.count("\n") + 2, "expected 'subroutine name()' after @test")

    def test_hook_without_its_subroutine_on_the_next_line(self):
        for other in ("", "! note", "pure subroutine prepare()", "@test", "@after", "#ifdef DEMO"):
            self.refuse(self.edit("subroutine prepare()\n      c", other + "\n      c", 7), 7,
                        "expected 'subroutine name()' after @before")

    def test_misplaced_disable(self):
        early = self.edit("@Test(ifdef=DEMO)\n   @disable", "@disable\n   @Test(ifdef=DEMO)", 18)
        self.refuse(early, 18, "@disable stands once, between")
        late = self.edit("Subroutine second\n", "Subroutine second\n   @disable\n", 20)
        self.refuse(late, 21, "@disable stands once")
        self.refuse(self.edit("@disable\n", "@disable\n   @disable\n", 19), 20, "@disable stands once")
        self.refuse(self.edit("@before\n", "@before\n   @disable\n", 6), 7, "@disable stands once")

    def test_second_hook(self):
        self.refuse(self.edit("@test\n", "@before\n", 11), 11, "a second @before")

    def test_duplicate_test(self):
        self.refuse(self.edit("Subroutine second\n", "subroutine First()\n", 20), 20, "a second test named First")

    def test_module_statement(self):
        for other in ("module test_other", "module test_demo ! note", "module Test_demo", "program test_demo",
                      "subroutine bare()"):
            self.refuse(self.edit("module test_demo\n   u", other + "\n   u", 1), 1, "the first statement is")
        self.refuse(GOOD + "module test_more\nend module test_more\n", GOOD.count("\n") + 1, "has one module")

    def test_module_name(self):
        for name in ("Test_demo", "wrap_demo", "pf_demo", "loader", "test-demo", "1st", "t" * 58):
            self.refuse(GOOD.replace("test_demo", name), 1, "no module name of the subset", name)

    def test_use_funit(self):
        for other in ("use funit, only: assertTrue", "use, non_intrinsic :: funit", "use :: funit",
                      "USE FUNIT\n   use funit"):
            self.refuse(self.edit("use funit", other, 2), 2 + other.count("\n"), "'use funit' stands once")
        self.refuse(self.edit("subroutine first()\n", "subroutine first()\n   use funit\n", 14), 15, "at module level")
        self.refuse(self.edit("   use funit\n", "\n", 2).replace("\n\n", "\n", 1), 1, "'use funit' is missing")

    def test_text_that_cpp_takes(self):
        self.refuse(self.edit("comment and a blank line may stand here.", "comment \\", 12), 12, "cpp")
        self.refuse(self.edit("comment and a blank line may stand here.", "comment /* here", 12), 12, "cpp")

    def test_missing_file(self):
        run = subprocess.run([sys.executable, PREPROCESSOR, self.directory / "none.pf", self.output],
                             capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 1)
        self.assertIn("none.pf: error: ", run.stderr)


class Results(Case):
    """What is inside the subset compiles, and what the compiler says points into the .pf file."""

    def compile(self, text, *options):
        """Preprocesses the text and checks the result with the compiler; returns what that says."""
        self.assertEqual(self.preprocess(text).returncode, 0)
        return subprocess.run([os.environ["FC"], "-std=f2018", "-Wall", "-Wextra", "-pedantic", "-fsyntax-only",
                               "-I", os.environ["FUNIT_MODULES"], *options, self.output],
                              cwd=self.directory, capture_output=True, text=True, check=False)

    def assert_refused(self, text, line, message):
        run = self.compile(text)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn(f"{self.source}:{line}:", run.stderr)
        self.assertIn(message, run.stderr)

    def test_good_file_compiles_without_warning(self):
        for options in ([], ["-DDEMO"]):
            run = self.compile(GOOD, *options)
            self.assertEqual((run.returncode, run.stderr), (0, ""))

    def test_comments_are_copied(self):
        text = self.edit("! A comment and a blank line may stand here.", "!@assertTrue(.false.)", 12)
        self.preprocess(text)
        self.assertIn("\n   !@assertTrue(.false.)\n\n   subroutine first()\n", self.output.read_text(encoding="utf-8"))

    def test_assertion_without_arguments(self):
        run = self.compile(self.edit(ASSERTION, "@assertExceptionRaised()", ASSERT_LINE))
        self.assertEqual((run.returncode, run.stderr), (0, ""))

    def test_compile_error_is_on_its_line(self):
        self.assert_refused(self.edit("counter = counter + 1", "counter = contour + 1", 8), 8, "contour")
        self.assert_refused(self.edit(ASSERTION, "@assertTrue(contour)", ASSERT_LINE), ASSERT_LINE, "contour")
        after = self.edit(ASSERTION, ASSERTION + "\n      contour = 1", ASSERT_LINE)
        self.assert_refused(after, ASSERT_LINE + 1, "contour")

    def test_assertion_behind_a_condition_does_not_compile(self):
        self.assert_refused(self.edit(ASSERTION, "if (counter > 0) @assertTrue(.true.)", ASSERT_LINE), ASSERT_LINE, "@")

    def test_arguments_outside_the_subset_do_not_compile(self):
        for other in ("@assertEqual(1.0, 1.0)", "@assertEqual(1, 1.0d0)", "@assertEqual(1.0d0, 1.0d0, tolerance=1.0)",
                      "@assertEqual((1.0, 0.0), (1.0, 0.0))", "@assertEqual(['a'], ['a'])",
                      "@assertEqual(1.0d0, 1.0d0, 'message')", "@assertNotEqual([1], [2])",
                      "@assertRelativelyEqual(1.0d0, 1.0d0)", "@assertLessThan(1.0d0, 2.0d0, tolerance=1.0d0)",
                      "@assertTrue()", "@assertIsNaN([1.0d0])", "@assertEqual(.true., [.true.])"):
            self.assert_refused(self.edit(ASSERTION, other, ASSERT_LINE), ASSERT_LINE, "Error")

    def test_names_of_funit_are_taken(self):
        for name in ("t", "suite"):
            self.assert_refused(GOOD.replace("counter", name), 1, name)
        for name in ("run", "test", "not", "true", "throw", "assertEqual"):
            self.assert_refused(self.edit("counter = 0", f"counter = 0, {name} = 0", 4), 4, name)
            text = self.edit("   subroutine prepare()\n      c", f"   subroutine {name}()\n      c", 7)
            self.assert_refused(text.replace("end subroutine prepare", f"end subroutine {name}"), 7, name)

    def test_names_of_funit_are_free_inside_a_test(self):
        names = "integer :: t, suite, run\n      t = 1; suite = 1; run = 1\n      @assertEqual([t, suite], [run, 1])"
        run = self.compile(self.edit(ASSERTION, names, ASSERT_LINE))
        self.assertEqual((run.returncode, run.stderr), (0, ""))

    def test_private_test_does_not_compile(self):
        self.assert_refused(self.edit("   implicit none\n", "   implicit none; private\n", 3), 14, "first")


if __name__ == "__main__":
    unittest.main()
