"""Judges solved cases by their summaries: a color, and a sentence that says why and what to do."""
from __future__ import annotations

from typing import Any

from amontons.numerals import scientific


# What is wrong where a violation is too large; any other is told by its name.
SENTENCES = {
    "equilibrium": "forces at some node do not balance",
    "penetration": "the body penetrates the obstacle",
    "penetration_outside": "the boundary outside the contact sets penetrates an obstacle or another body: enlarge the "
        "sets, or search, so that they contain all that may touch",
    "penetration_between": "a corner of the obstacle penetrates the body between contact points: refine the mesh there",
    "tension": "the obstacle pulls at the body",
    "friction_excess": "friction exceeds its bound",
    "complementarity": "there is a contact force across a gap",
    "wrong_dissipation": "friction drives the slip somewhere",
    "slip_below_bound": "a point slips though friction is below its bound",
    "resultant": "the forces on the body do not add up to zero",
    "moment": "the moments on the body do not add up to zero",
    "energy": "strain energy and work of the forces differ",
    "pair_force": "the forces on both bodies of a pair differ",
    "pair_moment": "the moments on both bodies of a pair differ",
    "tie_moment": "the moments on both sides of a tie differ",
    "duality_gap": "the energies of displacements and of contact forces differ",
}
# What else stands in a certificate.
NO_VIOLATIONS = ("case", "passed", "limit", "strain_energy", "work_of_friction")
# A violation up to here leaves a picture that an engineer can use, and numbers that nobody should cite.
USABLE = 1e-4
COLORS = ("green", "amber", "red")


def violations(summary: dict[str, Any]) -> dict[str, float]:
    """The violations in the certificate of a case, infinite where one is not a number; none of a sweep without a case
    that converged, which has no certificate."""
    certificate = summary.get("certificate", {})
    return {name: float("inf") if value is None else value
            for name, value in certificate.items() if name not in NO_VIOLATIONS}


def verdict_of(summary: dict[str, Any]) -> tuple[str, str]:
    """The color of a case, and the sentence that goes with it."""
    found_violations, residual = violations(summary), summary.get("residual")
    largest = max(found_violations.values(), default=float("inf"))
    what = "the file's own matrix" if "problem" in summary else "the full model"
    is_certified = bool(found_violations) and summary["certificate"]["passed"]
    faults = [SENTENCES.get(name, f"{name.replace('_', ' ')} is too large")
              for name, value in found_violations.items() if value > summary["certificate"]["limit"]]
    steps = summary.get("load_history", {})
    if is_certified and steps.get("violation", 0.0) > summary["certificate"]["limit"]:
        is_certified, largest = False, max(largest, steps["violation"])
        faults = [f"step {steps['violation_step']} violates a condition by {scientific(steps['violation'], 2)}"]
    found = f"On {what}: {'; '.join(faults)}. " if faults else ""
    if "sweep" in summary and not (is_certified and summary["sweep"]["solved"] == summary["sweep"]["cases"]):
        return _verdict_of_sweep(summary["sweep"], is_certified, found)
    if summary["converged"] and is_certified:
        which = f"; checked for the worst case, {summary['certificate']['case']}" if "sweep" in summary else ""
        color = "amber" if summary.get("warnings") else "green"
        return color, f"Solved and certified: largest relative error on {what} {scientific(largest, 2)} " \
            f"(limit {scientific(summary['certificate']['limit'], 2)}){which}."
    if not steps.get("complete", True):
        return "amber", f"Incomplete: {steps['end']}. What is shown is the last state, " + \
            ("certified." if is_certified else "not certified. " + found)
    if not summary["converged"]:
        residual_text = "not a number" if residual is None else scientific(residual, 2)
        found = f"The method stopped after {summary['iterations']} iterations with a residual of {residual_text}. " \
            + found
    if residual is not None and max(residual, largest) <= USABLE:
        return "amber", found + f"No error exceeds {scientific(USABLE, 2)} of its scale: good enough to look at, not " \
            "to cite. Raise max_iterations, or use method = 'auto'."
    too_large = {name for name, value in found_violations.items() if value > summary["certificate"]["limit"]}
    if summary["converged"] and too_large <= {"penetration_outside", "penetration_between"}:
        return "red", found + "Do not use these numbers."
    if summary["converged"]:
        return "red", found + "Do not use these numbers. The stiffness may be ill-conditioned: look for slivers in " \
            "the mesh, for moduli that differ by many powers of ten, and for a Poisson's ratio close to 0.5."
    return "red", found + "Do not use these numbers. Use method = 'auto'; if that failed, raise max_iterations, " \
        "lower the friction in steps to see where it begins, or check that the loads press the body on its obstacle."


def _verdict_of_sweep(counts: dict[str, int], is_certified: bool, found: str) -> tuple[str, str]:
    """The same of a sweep that is not green."""
    left = []
    if counts["not_converged"]:
        left.append(f"{counts['not_converged']} did not converge: use method = 'auto', or raise max_iterations")
    if counts.get("numerical_failure"):
        left.append(f"{counts['numerical_failure']} leave the range of numbers: check units, loads and distances")
    if counts["no_equilibrium"]:
        left.append(f"{counts['no_equilibrium']} have no equilibrium: contact and friction cannot balance their loads")
    found = f"Of {counts['cases']} cases, " + "; ".join(left) + " (column outcome). " + found if left else found
    if not counts["solved"]:
        return "red", found + "No case is solved."
    if not is_certified:
        return "red", found + "Do not use these numbers: the certificate of the worst case failed."
    return "amber", found + "The others are solved, and the worst of them is certified."
