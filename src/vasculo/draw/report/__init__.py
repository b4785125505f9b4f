"""The report of a run, or of a few side by side: one HTML page that can be mailed."""

from vasculo.draw.report.beside import write_side_by_side
from vasculo.draw.report.write import write_report

__all__ = ["write_report", "write_side_by_side"]
