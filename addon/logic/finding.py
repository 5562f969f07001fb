"""Something that is off with a character, as panels, the log and commands tell it."""

from __future__ import annotations

from dataclasses import dataclass

# From worst to least: the mesh is as it would be without ours; something is not as it should be; good to know.
SEVERITIES = ("ERROR", "WARNING", "INFO")


@dataclass(frozen=True)
class Finding:
    """Something that is off with a character."""

    id: str  # stable, for scripts and tests
    severity: str  # of SEVERITIES
    text: str  # a sentence for the artist: what was found, what to do
    fix: str = ""  # of properties.fixes; empty where there is none
    subject: str = ""  # what the fix changes: names of modifiers, joints or a vertex group, one per line
    refusal: str = ""  # why the fix cannot be applied here

    @property
    def logged_as(self) -> tuple[str, ...]:
        """Equal for findings of which the log holds one; what is only good to know comes with figures of a frame."""
        return (self.id, self.subject) if self.severity == "INFO" else (self.text,)


def worst_first(findings: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """Sorted by severity; findings of one severity stay in their order."""
    return tuple(sorted(findings, key=lambda finding: SEVERITIES.index(finding.severity)))
