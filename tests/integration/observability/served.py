"""The metrics of a running server, and whether an expression can be evaluated with them."""
import pathlib
import re
import sys
import tempfile
import urllib.request

from promql import selectors

SOURCE = pathlib.Path(__file__).resolve().parents[3]
DOCS = SOURCE / "docs"
sys.path.insert(0, str(SOURCE / "tests/integration/robot_client/python"))
from programs import RunningServer  # noqa: E402

SAMPLE = re.compile(r'(\w+)(?:\{(.*)\})? \S+')
LABEL = re.compile(r'(\w+)="((?:[^"\\]|\\.)*)"')
OF_COUNTERS = {"rate", "increase", "resets"}
OF_HISTOGRAMS = ("_bucket", "_sum", "_count")
PROMETHEUS_LABELS = {"instance", "job"}  # Prometheus adds them to all series


class Served:
    """Families by name with their type, and of each sample the labels with their values."""

    def __init__(self, text):
        self.families = dict(re.findall(r"^# TYPE (\w+) (\w+)$", text, re.MULTILINE))
        self.samples = {"up": {}}  # Prometheus adds it
        for line in text.splitlines():
            if not line.startswith("#"):
                name, labels = SAMPLE.fullmatch(line).groups()
                seen = self.samples.setdefault(name, {})
                for label, value in LABEL.findall(labels or ""):
                    seen.setdefault(label, set()).add(value)

    def family_of(self, sample):
        for suffix in OF_HISTOGRAMS:
            base = sample[:-len(suffix)]
            if sample.endswith(suffix) and self.families.get(base) == "histogram":
                return base
        return sample

    def complaints_about(self, expression):
        """Yields a sentence for each missing metric or label, and for each counter that is used without rate()."""
        return [complaint for selector in selectors(expression) for complaint in self._complaints(selector)]

    def _complaints(self, selector):
        labels = self.samples.get(selector.metric)
        if labels is None:
            yield f"no metric {selector.metric}"
            return
        for label, (operator, value) in selector.matchers.items():
            if label not in PROMETHEUS_LABELS and label not in labels:
                yield f"{selector.metric} has no label {label}"
            elif operator == "=" and label in labels and value not in labels[label]:
                yield f"{selector.metric} never has {label}={value}"
        for label in (selector.kept or set()) - PROMETHEUS_LABELS - labels.keys():
            yield f"{selector.metric} has no label {label}"
        counts = self.families.get(self.family_of(selector.metric)) in ("counter", "histogram")
        if counts != (selector.function in OF_COUNTERS):
            yield f"{selector.metric} is a {'counter' if counts else 'gauge'}, under {selector.function}"

    def labels_of(self, expression):
        """The labels that distinguish its results: those that every part keeps."""
        kept = []
        for selector in selectors(expression):
            labels = PROMETHEUS_LABELS | self.samples[selector.metric].keys()
            kept.append(labels if selector.kept is None else labels & selector.kept)
        return set.intersection(*kept)


def ask_a_server():
    with tempfile.TemporaryDirectory() as directory:
        server = RunningServer(directory)
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{server.http_port}/metrics") as answer:
                return Served(answer.read().decode())
        finally:
            server.stop()
