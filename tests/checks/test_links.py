"""The links that check_links.py refuses."""
import shutil
import subprocess
import unittest

from checker import CheckerTest


@unittest.skipUnless(shutil.which("git"), "git is not installed")
class Links(CheckerTest):
    """Two pages of a repository."""
    script = "check_links.py"

    def setUp(self):
        super().setUp()
        subprocess.run(["git", "init", "--quiet", self.root], check=True)
        self.write("doc/other.md", "# A heading\n\n## A `code` heading, twice\n\n## A `code` heading, twice\n")

    def assert_page(self, text, *faults):
        """Checks the faults of a page."""
        self.write("page.md", text)
        self.assert_finds(*(f"page.md:{fault}" for fault in faults))

    def test_links_that_lead_somewhere_are_accepted(self):
        self.assert_page("[file](doc/other.md), [heading](doc/other.md#a-heading), [own](#own), "
                         "[second](doc/other.md#a-code-heading-twice-1), [far](https://example.org/none)\n\n# Own\n\n"
                         "`[code](none.md)`\n```\n[code](none.md)\n```\n")

    def test_links_that_lead_nowhere_are_refused(self):
        self.assert_page("One [file](none.md)\n\nand [heading](doc/other.md#none), [own](#none) [text\n"
                         "of](doc/none.md).\n\n"
                         "[reference]: doc/gone.md\n",
                         "1: there is no none.md", "3: doc/other.md has no heading #none",
                         "3: page.md has no heading #none", "4: there is no doc/none.md", "6: there is no doc/gone.md")

    def test_names_that_the_sources_do_not_have_are_refused(self):
        self.write("src/base/amontons_kinds.f90", "subroutine take_step()\n")
        self.write("tests/app/test_some_thing.py", "")
        self.write("doc/architecture.md", "`take_step(x)`, `amontons_kinds.f90`, `program_some_thing`,\n"
                                          "`fuzz_FORMAT`, take_steps\n\n`take_steps` and `call a%leap_once`\n")
        self.write("page.md", "`take_leaps`\n")
        self.assert_finds("doc/architecture.md:4: the sources have no leap_once",
                          "doc/architecture.md:4: the sources have no take_steps")


if __name__ == "__main__":
    unittest.main()
