"""The sentences that check_sentences.py refuses."""
import unittest

from checker import CheckerTest

LONG = "word "*40 + "end"


class Sentences(CheckerTest):
    """Pages of a repository."""
    script = "check_sentences.py"

    def setUp(self):
        super().setUp()
        self.write("README.md", "# A page\n\nOne sentence.\n")

    def test_short_sentences_tables_and_code_are_accepted(self):
        self.write("doc/page.md", f"{LONG[5:]}. {LONG[5:]}.\n\n| {LONG} |\n\n```\n{LONG}\n```\n\n`{LONG}` ends.\n")
        self.assert_finds()

    def test_a_long_sentence_over_several_lines_is_refused(self):
        self.write("doc/page.md", "A sentence.\n\n* " + LONG.replace("word word", "word\n  word", 1) + ".\n")
        self.assert_finds(f"doc/page.md:3: a sentence of 41 words, at most 40: {LONG[:70]} ...")


if __name__ == "__main__":
    unittest.main()
