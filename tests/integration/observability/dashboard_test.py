"""The dashboard uses metrics that the server has, shows all of them, and is valid for Grafana."""
import itertools
import json
import re
import unittest

from promql import selectors
from served import DOCS, ask_a_server

# Metrics that the dashboard does not show, with the reason.
LEFT_OUT = {
    "scanloom_loops_accepted_total": "loops are counted for each robot in the session's JSON, where they mean more",
    "scanloom_loop_matches_total": "as for loops",
    "scanloom_loops_refused_total": "as for loops",
    "scanloom_loop_jump_metres": "as for loops",
    "scanloom_maps_corrected_total": "as for loops",
    "scanloom_robots_lost": "the viewer and the session's JSON say which robots",
    "scanloom_moving_scans": "0 but for seconds after a correction; the viewer shows it",
    "process_virtual_memory_bytes": "most of the address space is never used, so it is not the memory in use",
    "scanloom_sessions_checked_total": "progress of the check at startup; the damage that it finds is shown",
    "scanloom_store_torn_bytes_dropped_total": "constant after startup; the log reports it",
}
GRAFANA_VARIABLES = {"__all", "__rate_interval"}
COLUMNS = 24


def cells_of(panel):
    at = panel["gridPos"]
    return set(itertools.product(range(at["x"], at["x"] + at["w"]), range(at["y"], at["y"] + at["h"])))


class Dashboard(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = (DOCS / "observability/scanloom-dashboard.json").read_text()
        cls.dashboard = json.loads(cls.text)
        cls.panels = cls.dashboard["panels"]
        cls.shown = [panel for panel in cls.panels if panel["type"] != "row"]
        cls.instance = next(one for one in cls.dashboard["templating"]["list"] if one["name"] == "instance")
        cls.served = ask_a_server()

    def targets(self):
        for panel in self.shown:
            for target in panel["targets"]:
                yield panel, target

    def test_every_panel_uses_metrics_of_the_server(self):
        for panel, target in self.targets():
            with self.subTest(panel["title"], query=target["expr"]):
                self.assertTrue(selectors(target["expr"]))
                self.assertEqual(self.served.complaints_about(target["expr"]), [])

    def test_every_metric_is_shown_or_left_out_on_purpose(self):
        shown = {self.served.family_of(selector.metric) for _, target in self.targets()
                 for selector in selectors(target["expr"])}
        self.assertEqual(self.served.families.keys() - shown, LEFT_OUT.keys())

    def test_legends_name_labels_that_the_results_have(self):
        for panel, target in self.targets():
            with self.subTest(panel["title"], query=target["expr"]):
                named = set(re.findall(r"\{\{\s*(\w+)\s*\}\}", target["legendFormat"]))
                self.assertLessEqual(named, self.served.labels_of(target["expr"]))

    def test_only_the_chosen_servers_are_queried(self):
        for panel, target in self.targets():
            for selector in selectors(target["expr"]):
                with self.subTest(panel["title"], metric=selector.metric):
                    self.assertEqual(selector.matchers.get("instance"), ("=~", "$instance"))

    def test_every_panel_has_a_description_and_a_unit(self):
        for panel in self.shown:
            with self.subTest(panel["title"]):
                self.assertGreater(len(panel["description"]), 10)
                self.assertTrue(panel["fieldConfig"]["defaults"]["unit"])

    def test_identities_are_unique(self):
        for what in ("id", "title"):
            values = [panel[what] for panel in self.panels]
            self.assertEqual(sorted(values), sorted(set(values)))
        for panel in self.shown:
            refs = [target["refId"] for target in panel["targets"]]
            self.assertEqual(sorted(refs), sorted(set(refs)), panel["title"])

    def test_panels_do_not_overlap(self):
        for panel in self.panels:
            at = panel["gridPos"]
            self.assertTrue(0 <= at["x"] < at["x"] + at["w"] <= COLUMNS and at["h"] > 0, panel["title"])
        for one, other in itertools.combinations(self.panels, 2):
            self.assertFalse(cells_of(one) & cells_of(other), f"{one['title']} overlaps {other['title']}")

    def test_variables_are_declared_and_there_is_one_data_source(self):
        declared = {variable["name"] for variable in self.dashboard["templating"]["list"]} | GRAFANA_VARIABLES
        self.assertLessEqual(set(re.findall(r"\$\{?(\w+)", self.text)), declared)
        for asked in [self.instance, *self.shown, *(target for _, target in self.targets())]:
            self.assertEqual(asked["datasource"], {"type": "prometheus", "uid": "${datasource}"}, asked)

    def test_the_list_of_servers_comes_from_an_existing_metric(self):
        query = self.instance["query"]["query"]
        self.assertEqual(self.instance["definition"], query)
        metric, label = re.fullmatch(r"label_values\((\w+), (\w+)\)", query).groups()
        self.assertIn(metric, self.served.families)
        self.assertEqual(label, "instance")


if __name__ == "__main__":
    unittest.main()
