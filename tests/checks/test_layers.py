"""The rules that check_layers.py checks, each with a file that breaks it."""
import unittest

from checker import CheckerTest


def module(name, *lines):
    """The text of a module."""
    return "\n".join((f"module {name}", *(f"   {line}" for line in lines), f"end module {name}", ""))


class Layers(CheckerTest):
    """A lower module and one above it."""
    script = "check_layers.py"

    def setUp(self):
        super().setUp()
        self.write("src/base/amontons_low.f90", module("amontons_low", "use, intrinsic :: iso_c_binding, only: c_int"))
        self.write("src/contact/amontons_high.f90", module("amontons_high", "use amontons_low, only: a"))

    def test_use_of_a_lower_layer_is_accepted(self):
        self.assert_finds()

    def test_use_of_a_higher_layer_is_refused(self):
        self.write("src/base/amontons_low.f90", module("amontons_low", "use amontons_high, only: b"))
        self.assert_finds("src/base/amontons_low.f90:2: layer base may not use amontons_high of layer contact above it")

    def test_unknown_module_is_refused(self):
        self.write("src/contact/amontons_high.f90", module("amontons_high", "use :: amontons_none, only: b"))
        self.assert_finds("src/contact/amontons_high.f90:2: there is no module amontons_none in src/")

    def test_words_of_linear_algebra_are_refused_elsewhere(self):
        for word in ("cholmod", "UMFPACK", "dpbtrf"):
            self.write("src/contact/amontons_high.f90", module("amontons_high", f"! {word}"))
            self.assert_finds(f"src/contact/amontons_high.f90:2: only the layer linalg may say {word}")

    def test_file_is_a_module(self):
        self.write("src/contact/amontons_high.f90", module("amontons_higher"))
        self.assert_finds("src/contact/amontons_high.f90:1: this file must hold amontons_high and nothing else, "
                          "it holds: amontons_higher")

    def test_folder_is_a_layer(self):
        self.write("src/attic/amontons_old.f90", module("amontons_old"))
        self.assert_finds("src/attic/amontons_old.f90:1: the layers are the folders base, linalg, fem, contact, case, "
                          "binding and app")

    def test_procedure_of_c_may_not_be_called_like_a_module(self):
        self.write("src/contact/amontons_high.f90",
                   module("amontons_high", "subroutine f() bind(c, name='amontons_low')"))
        self.assert_finds("src/contact/amontons_high.f90:2: amontons_low is a module already; "
                          "give the procedure of C another name")


if __name__ == "__main__":
    unittest.main()
