"""The comment at the top of every exported file: where it comes from, and which effects the format cannot express."""

from __future__ import annotations

from msd_ident.data.provenance import versions
from msd_ident.export import quoting
from msd_ident.export.plan import FORCES, Plan
from msd_ident.export.target import Target
from msd_ident.quantity import Z95

#: What a force sign of -1 says.
DOWNWARDS = "a positive force moves the encoder downwards"


def text(plan: Plan, target: str, turned: str = Target.turned) -> str:
    """The header without comment signs."""
    return "\n".join(lines(plan, target, turned))


def xml_text(plan: Plan, target: str, turned: str = Target.turned) -> str:
    """The header for an XML comment."""
    return quoting.in_xml_comment(text(plan, target, turned))


def lines(plan: Plan, target: str, turned: str = Target.turned) -> list[str]:
    """Lines of the header, without comment signs, safe in a docstring and in comments.

    Args:
        plan: what is exported.
        target: the format, in a few words.
        turned: what it does with a force whose positive values move the encoder downwards.
    """
    saved = plan.saved
    head = [
        f"{target}: exported by msd export (msd_ident {versions()['msd_ident']})",
        f"from a result of schema {saved.schema} on {saved.path or 'an unnamed record'}",
        "",
        f"{'parameter':<26} {'value':>12}   95 % of the fit",
    ]
    for name, value in plan.values.items():
        head.append(f"{name:<26} {value:>12.6g}   {_interval(plan, name)}")
    head += ["", *_units(plan, turned), *(f"- {row}" for row in plan.rows)]
    return [quoting.plain(line) for line in head]


def _interval(plan: Plan, name: str) -> str:
    quantity = plan.saved.parameters.get(name)
    if quantity is None or plan.saved.model.names != plan.model.names:
        return "refitted to replace what is missing" if quantity is None else f"was {quantity.value:.6g}"
    if not quantity.known:
        return f"open, {quantity.unit}"
    scale = plan.values[name] / quantity.value if quantity.value else 1.0
    return f"+- {Z95 * abs(scale) * quantity.std:.2g} {quantity.unit}"


def _units(plan: Plan, turned: str) -> list[str]:
    saved = plan.saved
    notes = [f"positions in {saved.position_unit}, as the encoder reads them; the spring is relaxed at {plan.zero:.6g}"]
    if saved.force_unit not in FORCES:
        notes.append(f"forces in {saved.force_unit}: the motion is right, masses are in {saved.force_unit} per m/s^2")
    elif saved.scale_assumed:
        notes.append("no force scale was measured: the motion is right, forces are those of a mass of 1 kg")
    if saved.force_sign < 0:
        notes.append(f"{DOWNWARDS}: {turned}")
    return notes
