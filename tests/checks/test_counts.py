"""What count_tests.py counts, and that it does not take for passed what was not run."""
import subprocess
import sys
import unittest

from checker import SCRIPTS, CheckerTest

CASE = '<testcase name="{name}" status="{status}">{skipped}<system-out>{output}</system-out></testcase>'


class Counts(CheckerTest):
    """A JUnit file of ctest."""

    def assert_counted(self, cases, sentence, status):
        """Checks what is printed of tests, given by status and output, and the exit status."""
        text = "".join(CASE.format(name=i, status=state, output=output,
                                   skipped='<skipped message="SKIP_RETURN_CODE=1"/>' if state == "notrun" else "")
                       for i, (state, output) in enumerate(cases))
        self.write("results.xml", f"<testsuite>{text}</testsuite>")
        run = subprocess.run([sys.executable, "-B", SCRIPTS / "count_tests.py", self.root / "results.xml"],
                             capture_output=True, encoding="utf-8", check=False)
        self.assertEqual((run.stdout, run.returncode), (f"{sentence}\n", status))

    def test_unit_tests_count_one_by_one(self):
        self.assert_counted([("run", " OK\n (13 tests, 1 disabled)\n"), ("run", "as it likes")],
                            "14 passed, 0 failed, 1 skipped", 0)

    def test_failures_are_counted(self):
        self.assert_counted([("fail", "Tests run: 39, Failures: 38, Errors: 0\n"), ("fail", "")],
                            "1 passed, 39 failed", 1)

    def test_crash_after_the_summary_is_a_failure(self):
        self.assert_counted([("fail", " OK\n (3 tests)\n")], "3 passed, 1 failed", 1)

    def test_nothing_run_is_no_success(self):
        self.assert_counted([], "0 passed, 0 failed", 1)
        self.assert_counted([("notrun", "")], "0 passed, 0 failed, 1 skipped", 1)


if __name__ == "__main__":
    unittest.main()
