"""Three parts of one whole, as sliders."""

Shares = tuple[float, float, float]

THIRDS: Shares = (1 / 3, 1 / 3, 1 / 3)
# Sums are this near to one where parts were rounded to float32.
SUM_TOLERANCE = 1e-6


def balanced(found: Shares, before: Shares) -> Shares:
    """Parts that sum to one. Where one of them was moved from `before`, the others share the rest as they did.

    Where more were moved all are scaled; all set to zero stay so.
    """
    total = sum(found)
    if abs(total - 1.0) <= SUM_TOLERANCE:
        return found
    moved = [axis for axis in range(3) if abs(found[axis] - before[axis]) > SUM_TOLERANCE]
    if len(moved) != 1:
        return (found[0] / total, found[1] / total, found[2] / total) if total > 0.0 else found
    rest = 1.0 - found[moved[0]]
    others = sum(before) - before[moved[0]]
    parts = [rest * part / others if others > SUM_TOLERANCE else 0.5 * rest for part in before]
    parts[moved[0]] = found[moved[0]]
    return parts[0], parts[1], parts[2]
