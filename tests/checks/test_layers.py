"""The rules that check_layers.py checks, each with a file that breaks it."""
import unittest

from checker import CheckerTest


def module(name, *lines):
    """The text of a module."""
    return "\n".join((f"module {name}", *(f"   {line}" for line in lines), f"end module {name}", ""))


class Layers(CheckerTest):
    """A module of the lowest room and a contact method."""
    script = "check_layers.py"

    def setUp(self):
        super().setUp()
        self.write("src/base/amontons_low.f90", module("amontons_low", "use, intrinsic :: iso_c_binding, only: c_int"))
        self.write("src/contact/methods/amontons_high.f90", module("amontons_high", "use amontons_low, only: a"))

    def test_use_of_a_room_that_is_allowed_is_accepted(self):
        self.assert_finds()

    def test_use_of_another_room_is_refused(self):
        self.write("src/base/amontons_low.f90", module("amontons_low", "use amontons_high, only: b"))
        self.assert_finds("src/base/amontons_low.f90:2: base may not use amontons_high of contact/methods")

    def test_methods_see_the_contact_problem_only(self):
        self.write("src/contact/model/amontons_body.f90", module("amontons_body"))
        self.write("src/contact/methods/amontons_high.f90", module("amontons_high", "use amontons_body, only: b"))
        self.assert_finds("src/contact/methods/amontons_high.f90:2: contact/methods may not use amontons_body of "
                          "contact/model")

    def test_right_that_no_module_uses_is_refused(self):
        self.write("src/contact/problem/amontons_waist.f90", module("amontons_waist"))
        self.assert_finds("src/contact/methods:1: no module here uses contact/problem: "
                          "take it from the list of what contact/methods may use")

    def test_unknown_module_is_refused(self):
        self.write("src/contact/methods/amontons_high.f90", module("amontons_high", "use :: amontons_none, only: b"))
        self.assert_finds("src/contact/methods/amontons_high.f90:2: there is no module amontons_none in src/")

    def test_words_of_linear_algebra_are_refused_elsewhere(self):
        for word, rooms in (("cholmod", "cholesky"), ("UMFPACK", "linalg"), ("dpbtrf", "linalg or cholesky")):
            self.write("src/contact/methods/amontons_high.f90", module("amontons_high", f"! {word}"))
            self.assert_finds(f"src/contact/methods/amontons_high.f90:2: only the room {rooms} may say {word}")

    def test_file_is_a_module(self):
        self.write("src/contact/methods/amontons_high.f90", module("amontons_higher"))
        self.assert_finds("src/contact/methods/amontons_high.f90:1: this file must hold amontons_high and nothing "
                          "else, it holds: amontons_higher")

    def test_folder_is_a_room(self):
        self.write("src/attic/amontons_old.f90", module("amontons_old"))
        run = self.run_checker()
        self.assertRegex(run.stdout, r"^src/attic/amontons_old.f90:1: the rooms are the folders base, .* and app\n$")
        self.assertEqual(run.returncode, 1)

    def test_procedure_of_c_may_not_be_called_like_a_module(self):
        self.write("src/contact/methods/amontons_high.f90",
                   module("amontons_high", "subroutine f() bind(c, name='amontons_low')"))
        self.assert_finds("src/contact/methods/amontons_high.f90:2: amontons_low is a module already; "
                          "give the procedure of C another name")


if __name__ == "__main__":
    unittest.main()
