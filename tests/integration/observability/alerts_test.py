"""The alerts use metrics and labels that the server has, and say what to do."""
import pathlib
import re
import unittest

import yaml

from promql import selectors
from served import DOCS, PROMETHEUS_LABELS, ask_a_server

HERE = pathlib.Path(__file__).resolve().parent


def alerts():
    groups = yaml.safe_load((DOCS / "observability/alerts.yml").read_text())["groups"]
    return [rule for group in groups for rule in group["rules"]]


def cases():
    return yaml.safe_load((HERE / "alerts_cases.yml").read_text())["tests"]


class Alerts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.served = ask_a_server()

    def test_every_alert_uses_metrics_of_the_server(self):
        for alert in alerts():
            with self.subTest(alert["alert"]):
                self.assertTrue(selectors(alert["expr"]))
                self.assertEqual(self.served.complaints_about(alert["expr"]), [])

    def test_texts_name_labels_that_the_results_have(self):
        for alert in alerts():
            with self.subTest(alert["alert"]):
                named = set(re.findall(r"\$labels\.(\w+)", " ".join(alert["annotations"].values())))
                self.assertIn("instance", named)
                self.assertLessEqual(named, self.served.labels_of(alert["expr"]))

    def test_texts_name_existing_metrics(self):
        for alert in alerts():
            for name in re.findall(r"\bscanloom_\w+", " ".join(alert["annotations"].values())):
                self.assertIn(name, self.served.samples, alert["alert"])

    def test_every_alert_has_a_name_a_severity_and_says_what_to_do(self):
        names = [alert["alert"] for alert in alerts()]
        self.assertEqual(len(names), len(set(names)))
        for alert in alerts():
            with self.subTest(alert["alert"]):
                self.assertIn(alert["labels"]["severity"], ("critical", "warning"))
                self.assertEqual(alert["annotations"].keys(), {"summary", "description"})
                self.assertTrue(alert["annotations"]["description"].endswith("."))

    def test_every_alert_fires_in_a_case(self):
        fired = {name for case in cases() for asked in case["promql_expr_test"] for sample in asked["exp_samples"]
                 for name in re.findall(r'alertname="(\w+)"', sample["labels"])}
        self.assertEqual(fired, {alert["alert"] for alert in alerts()})

    def test_cases_use_existing_metrics_and_labels(self):
        for series in (series["series"] for case in cases() for series in case["input_series"]):
            [selector] = selectors(series)
            self.assertIn(selector.metric, self.served.samples)
            self.assertEqual(selector.matchers.keys() - PROMETHEUS_LABELS,
                             self.served.samples[selector.metric].keys(), series)

    def test_alerts_name_the_job_of_the_manual(self):
        manual = (DOCS / "operations.md").read_text()
        blocks = map(yaml.safe_load, re.findall(r"```yaml\n(.*?)```", manual, re.DOTALL))
        config = next(block for block in blocks if "scrape_configs" in block)
        jobs = {scraped["job_name"] for scraped in config["scrape_configs"]}
        named = {selector.matchers["job"] for alert in alerts() for selector in selectors(alert["expr"])
                 if "job" in selector.matchers}
        self.assertEqual(named, {("=", job) for job in jobs})


if __name__ == "__main__":
    unittest.main()
