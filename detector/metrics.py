"""How well a detected door covers the true one (section 7.1)."""

from __future__ import annotations

from dataclasses import dataclass

from detector.result import Rectangle


@dataclass(frozen=True)
class Overlap:
    """Areas of a detected door Q and a true door G (equations 2 to 4), and what follows from them."""

    true_positive: float
    """Q and G [m2], equation 2."""
    false_positive: float
    """Q without G [m2], equation 3."""
    false_negative: float
    """G without Q [m2], equation 4."""

    @property
    def precision(self) -> float:
        """Share of the detected door that is door (equation 5); 0 for an empty detection."""
        return _ratio(self.true_positive, self.false_positive + self.true_positive)

    @property
    def recall(self) -> float:
        """Share of the door that is detected (equation 6); 0 for an empty door."""
        return _ratio(self.true_positive, self.false_negative + self.true_positive)

    @property
    def iou(self) -> float:
        """Intersection over union; 0 for two empty rectangles."""
        return _ratio(self.true_positive, self.true_positive + self.false_positive + self.false_negative)

    @property
    def absolute_error(self) -> float:
        """e_abs [m2], equation 8."""
        return self.false_positive + self.false_negative

    @property
    def relative_error(self) -> float:
        """e_rel, equation 9; infinite for an empty door."""
        area = self.false_negative + self.true_positive
        return self.absolute_error / area if area > 0 else float("inf")

    def f_measure(self, beta: float = 1.0) -> float:
        """F_beta (equation 7): below 1 weighs precision, above 1 recall."""
        precision, recall = self.precision, self.recall
        return _ratio((1 + beta**2) * precision * recall, beta**2 * precision + recall)


def overlap(detected: Rectangle, true: Rectangle) -> Overlap:
    """Overlap of two rectangles on the same wall."""
    width = min(detected.right, true.right) - max(detected.left, true.left)
    height = min(detected.top, true.top) - max(detected.bottom, true.bottom)
    common = max(width, 0.0) * max(height, 0.0)
    return Overlap(common, detected.area - common, true.area - common)


def _ratio(numerator: float, denominator: float) -> float:
    """The quotient, 0 where there is nothing to divide by."""
    return numerator / denominator if denominator > 0 else 0.0
