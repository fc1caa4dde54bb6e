"""What check_tests.py refuses: tests that are never run, and tests that ask nothing."""
import unittest

from checker import CheckerTest

UNIT = """\
module test_one
contains
   @test
   subroutine first()
      {first}
   end subroutine first

   subroutine helper()
      @assertTrue(.true.)
   end subroutine helper
end module test_one
"""
SCRIPT = """\
import unittest
class One(unittest.TestCase):
    def test_first(self):
        self.fail()
if __name__ == "__main__":
    unittest.main()
"""
UNLISTED = "no CMakeLists.txt of its folder names it: it is never run"


class Tests(CheckerTest):
    """A folder with a unit test, a test of the program and a benchmark."""
    script = "check_tests.py"

    def setUp(self):
        super().setUp()
        self.write("tests/CMakeLists.txt", "add_subdirectory(base) # add_subdirectory(attic)\n")
        self.write("tests/base/CMakeLists.txt",
                   "add_unit_test(base SOURCES test_one.pf)\nadd_program_test(two program)\n"
                   "foreach(name three four)\n  add_program_test(${name} program)\nendforeach()\n"
                   "file(STRINGS benchmarks.txt names)\n# test_six.pf, add_program_test(six program)\n")
        self.write("tests/base/benchmarks.txt", "five\n")
        self.write("tests/base/test_one.pf", UNIT.format(first="@assertEqual(1, 1)"))
        self.write("src/base/deep/amontons_one.f90", "")
        for name in ("two", "three", "four", "five"):
            self.write(f"tests/base/test_{name}.py", SCRIPT)

    def test_files_that_are_listed_are_accepted(self):
        self.assert_finds()

    def test_files_that_are_not_listed_are_refused(self):
        self.write("tests/base/test_six.pf", UNIT.format(first="@assertEqual(1, 1)"))
        self.write("src/base/amontons_six.option.f90", "")
        self.write("tests/base/test_six.py", SCRIPT)
        self.write("tests/base/test_program.py", SCRIPT)
        self.assert_finds(*(f"tests/base/{name}:1: {UNLISTED}" for name in
                            ("test_six.pf", "test_six.py", "test_program.py")))

    def test_folder_that_is_not_added_is_refused(self):
        self.write("tests/attic/CMakeLists.txt", "add_program_test(old program)\n")
        self.write("tests/attic/test_old.py", SCRIPT)
        self.write("tests/cellar/test_older.py", SCRIPT)
        self.assert_finds("tests/attic/test_old.py:1: no add_subdirectory leads to its folder: it is never run",
                          f"tests/cellar/test_older.py:1: {UNLISTED}")

    def test_unit_test_that_no_module_is_named_after_is_refused(self):
        (self.root/"src/base/deep/amontons_one.f90").rename(self.root/"src/mesh.f90")
        self.write("src/mesh/amontons_one.f90", "")
        self.assert_finds("tests/base/test_one.pf:1: src/base has no module amontons_one: "
                          "a file of unit tests is named after its module")

    def test_unit_test_without_assertion_is_refused(self):
        self.write("tests/base/test_one.pf", UNIT.format(first="call work() ! @assertEqual(1, 1)"))
        self.assert_finds("tests/base/test_one.pf:4: the test first asserts nothing")
        self.write("tests/base/test_one.pf", UNIT.format(first="call helper()"))
        self.assert_finds()

    def test_script_that_runs_no_test_is_refused(self):
        self.write("tests/base/test_two.py", SCRIPT.partition("if __name__")[0])
        self.write("tests/base/test_three.py", SCRIPT.replace("test_first", "first"))
        self.assert_finds("tests/base/test_two.py:1: it does not run its tests when it is called",
                          "tests/base/test_three.py:1: there is no test in it")


if __name__ == "__main__":
    unittest.main()
