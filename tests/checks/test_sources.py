"""The rules that check_sources.py checks, each with a file that breaks it."""
import unittest

from checker import CheckerTest

MODULE = """\
!> A module.
module amontons_sample
   implicit none (type, external)
   private

   public :: {public}
{declarations}
contains

   !> A procedure.
   subroutine work(value)
      integer, intent(inout) :: value !! a value

{body}
   end subroutine work

end module amontons_sample
"""
FORBIDDEN = "the library neither stops nor prints"
UNCOMMENTED = "no !> above this public constant"


class Sources(CheckerTest):
    """One module of the library, sound but for what a test puts in."""
    script = "check_sources.py"

    def setUp(self):
        super().setUp()
        self.write("tests/taker.f90", "use amontons_sample, only: first, last, other, here => work\n")

    def assert_refused(self, text, *faults, body="value = 1", declarations="", public="work"):
        """Checks the faults, line and sentence, of the module with a body or declarations; `text` names the case."""
        with self.subTest(text):
            self.write("src/base/amontons_sample.f90", MODULE.format(
                public=public, declarations=declarations, body=body))
            self.assert_finds(*(f"src/base/amontons_sample.f90:{line}: {fault}" for line, fault in faults))

    def assert_body_refused(self, *bodies):
        """Checks that each of some statements is refused as one that stops or prints."""
        for body in bodies:
            self.assert_refused(body, (14, FORBIDDEN), body=body)

    def test_sound_module_is_accepted(self):
        self.assert_refused("sound")
        self.assert_refused("words in strings and comments",
                            body="text = 'a; stop' ! ; stop\nstopped = 1; printed = 2")
        self.assert_refused("a string over two lines", body="text = 'it goes on &\n   &; stop'")
        self.assert_refused("a write to a file", body="write (unit, '(a)') text; write (60, *) text")

    def test_stop_is_found(self):
        self.assert_body_refused("stop", "stop 1", "error stop 'no'", "errorstop", "STOP", "if (value > 0) stop",
                                 "if (f(value) > 0) error stop", "10 stop", "call exit(1)", "call abort()")

    def test_print_is_found(self):
        self.assert_body_refused("print *, value", "print '(i0)', value", "if (value > 0) print *, value",
                                 "write (*, *) value", "write (unit=*, fmt=*) value", "write (fmt=*, unit=*) value",
                                 "write (output_unit, '(a)') text", "write (error_unit, *) value", "write (6, *) value")

    def test_statements_that_share_a_line_are_all_read(self):
        self.assert_body_refused("value = 1; stop", "value = 1; print *, value", "value = 1;stop;value = 2",
                                 "text = 'a;b'; stop", "text = 'it''s'; stop", "value = 1; ; if (value > 0) stop",
                                 "value = 1 + &\n   2; stop", "text = 'it goes on &\n   &here'; stop")

    def test_tolerance_without_a_reason_is_found(self):
        for declaration, names in (("near = 1.0e-6_dp", "near"), ("near = 4.0_dp*epsilon(1.0_dp)", "near"),
                                   ("most = 2.0_dp, near = 1.0e-6_dp", "near"),
                                   ("weak(*) = [1.0e-3_dp, 1.0_dp], near = 1e-6", "weak, near")):
            body = f"real(dp), parameter :: {declaration}"
            self.assert_refused(body, (14, f"a tolerance without its reason: {names}"), body=body)
            self.assert_refused("a reason above", body=f"! A reason.\n{body}")
            self.assert_refused("a reason behind", body=f"{body} ! a reason")
        self.assert_refused("no tolerances", body="real(dp), parameter :: far = 1.0e3_dp, half = 0.5_dp\nx = 1.0e-3_dp")

    def test_search_beside_a_section_is_found(self):
        for body in ("x = a(:, findloc(b, .true., 1))", "x = a(1:2, &\n   minloc(b, 1))",
                     "associate (x => a(:, size(a, 2)))"):
            fault = "the result of findloc, minloc, maxloc, size beside a section: give it a name first"
            self.assert_refused(body, (14, fault), body=body)
        self.assert_refused("named first", body="i = findloc(b, .true., 1); x = a(:, i); y = f(a(:), maxval(b))")

    def test_public_constant_needs_a_comment(self):
        for declaration in ("integer, parameter :: first = 1", "character(len=4), parameter :: first = 'a'",
                            "real(kind=dp), parameter :: first(2) = [1.0_dp, 2.0_dp]",
                            "integer, parameter :: second = 2, first = 1"):
            self.assert_refused(declaration, (7, UNCOMMENTED), public="first, work", declarations=f"   {declaration}")
        self.assert_refused("attribute", (7, UNCOMMENTED), declarations="   integer, parameter, public :: first = 1")
        self.assert_refused("no colons", (8, UNCOMMENTED), declarations="   public first\n   integer :: first")
        self.assert_refused("continued list", (8, UNCOMMENTED), public="work, &\n      first",
                            declarations="   integer, parameter :: first = 1")
        self.assert_refused("commented", public="first, work",
                            declarations="   !> The first.\n   integer, parameter :: first = 1")
        self.assert_refused("private", declarations="   integer, parameter :: first = 1")

    def test_module_without_private_shows_everything(self):
        self.write("src/base/amontons_all.f90",
                   "!> All is public.\nmodule amontons_all\n   integer :: a\nend module amontons_all\n")
        self.assert_finds(f"src/base/amontons_all.f90:3: {UNCOMMENTED}")

    def test_components_and_arguments_need_comments(self):
        self.assert_refused("component", (9, "no !! at this component"), declarations=(
            "   !> A type.\n   type :: pair_t\n      character(len=3) :: name = 'a'\n   end type pair_t"))
        self.assert_refused("type", (7, "no !> above this type"),
                            declarations="   type :: empty_t\n   end type empty_t")
        self.assert_refused("procedure and argument", (16, "no !> above this subroutine"),
                            (17, "no !! at this argument: i"), body=(
            "   end subroutine work\n\n   subroutine other(i)\n      integer, intent(in) :: i\n"
            "   end subroutine other\n\n   !> A last one.\n   subroutine last()"), public="last, other, work")

    def test_unused_import_is_found(self):
        fault = "imported and never used: sum_of"
        for body in ("value = 1", "value = 1 ! sum_of", "text = 'sum_of'", "x%sum_of = 1", "call f(sum_of=1)"):
            self.assert_refused(body, (7, fault), declarations="   use other, only: sum_of", body=body)
        self.assert_refused("renamed", (7, fault), declarations="   use other, only: sum_of => total", body="x = total")
        self.assert_refused("continued, of two", (7, fault), body="x = total",
                            declarations="   use, intrinsic :: other, only: total, &\n      sum_of")
        self.assert_refused("body of an interface", (10, fault), declarations=(
            "   interface\n      !> Foreign.\n      subroutine f(n)\n         import :: sum_of\n"
            "         integer :: n\n      end subroutine f\n   end interface"))
        for body in ("value = sum_of(1)", "call f(n=sum_of)", "value = 1.0_sum_of", "!$omp parallel if (sum_of(1))"):
            self.assert_refused(body, declarations="   use other, only: sum_of", body=body)

    def test_private_procedure_that_nothing_calls_is_found(self):
        def with_other(call, inside="value = 1", heading="subroutine other()", end="subroutine other"):
            return f"{call}\n   end subroutine work\n\n   !> Another one.\n   {heading}\n{inside}\n   end {end}\n\n" \
                "   !> A public one.\n   subroutine last()"

        fault = (18, "a private procedure that nothing calls: other")
        for call in ("value = 1", "call x%other()", "text = 'other' ! other", "call f(other=1)"):
            self.assert_refused(call, fault, body=with_other(call), public="last, work")
        self.assert_refused("itself", fault, body=with_other("value = 1", inside="call other()"), public="last, work")
        self.assert_refused("its result", fault, public="last, work", body=with_other(
            "value = 1", "other = 1", "integer function other()", "function other"))
        for call in ("call other()", "call f(other)", "x = 1 + &\n other()"):
            self.assert_refused(call, body=with_other(call), public="last, work")
        self.assert_refused("of C", body=with_other("value = 1", heading="subroutine other() bind(c)"),
                            public="last, work")
        self.assert_refused("binding", body=with_other("value = 1"), public="last, work", declarations=(
            "   !> A type.\n   type :: thing_t\n   contains\n      procedure :: act => other\n   end type thing_t"))
        self.assert_refused("internal", (17, "a private procedure that nothing calls: inner"), body=(
            "value = 1\n   contains\n!> Inner.\n   subroutine inner()\n   value = 2\n   end subroutine inner"))

    def test_public_name_that_no_other_module_takes_is_found(self):
        fault = (6, "public, and no other module takes it: sum_of")
        self.assert_refused("alone", fault, public="sum_of, work")
        self.assert_refused("continued", fault, public="work, &\n      sum_of")
        self.assert_refused("attribute", (8, fault[1]),
                            declarations="   !> A sum.\n   integer, parameter, public :: sum_of = 1")
        self.write("src/base/amontons_own.f90", "!> Another.\nmodule amontons_own\n   private\n   public :: total\n"
                   "   use amontons_sample, only: total => sum_of\n   !> A sum.\n   integer :: total\n"
                   "end module amontons_own\n")
        self.write("tests/all.f90", "use amontons_own, only: work, &\n   total\n")
        self.assert_refused("taken", public="sum_of, work")

    def test_lengths_are_limited(self):
        self.assert_refused("line", (14, "a line of 121 columns, at most 120"), body="value = 1 !" + 110*"x")
        self.assert_refused("procedure", (11, "a procedure of 155 lines, at most 150"), body=150*"value = 1\n")
        self.write("src/base/amontons_sample.f90", 901*"\n")
        self.assert_finds("src/base/amontons_sample.f90:1: a file of 901 lines, at most 900")

    def test_other_places_and_languages(self):
        program = "!> A program.\nprogram main\n   print *, 'it may'; stop\nend program main\n"
        self.write("src/app/main.f90", program)
        self.assert_finds()
        self.write("src/base/sample.c", "int f(void)\n{\n    printf(\"no\");\n    exit(1);\n}\n")
        self.write("src/base/sample.F90", program)
        self.assert_finds(f"src/base/sample.c:3: {FORBIDDEN}", f"src/base/sample.c:4: {FORBIDDEN}",
                          "src/base/sample.F90:1: a file for the preprocessor")


if __name__ == "__main__":
    unittest.main()
