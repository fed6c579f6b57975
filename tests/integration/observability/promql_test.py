"""The selectors of expressions, by examples."""
import unittest

from promql import Selector, selectors


class Selectors(unittest.TestCase):
    def assert_found(self, expression, *found):
        self.assertEqual(selectors(expression), list(found))

    def test_a_name_alone_is_a_value(self):
        self.assert_found("up == 0", Selector("up", {}, None))

    def test_matchers_may_contain_any_text_in_quotes(self):
        self.assert_found('a{x="by (b)", y=~"$z|c"} > 1',
                          Selector("a", {"x": ("=", "by (b)"), "y": ("=~", "$z|c")}, None))

    def test_a_range_belongs_to_the_function_around_it(self):
        self.assert_found("resets(a[30m]) > 2 or b", Selector("a", {}, "resets"), Selector("b", {}, None))

    def test_labels_that_an_aggregation_keeps_are_found(self):
        self.assert_found("histogram_quantile(0.9, sum by (le, x) (rate(a_bucket[5m])))",
                          Selector("a_bucket", {}, "rate", frozenset({"le", "x"})))
        self.assert_found("60 * sum(rate(a[5m]))", Selector("a", {}, "rate", frozenset()))

    def test_each_part_of_an_expression_has_its_own_aggregation(self):
        self.assert_found("sum by (x) (a) / b offset 1h", Selector("a", {}, None, frozenset({"x"})),
                          Selector("b", {}, None))

    def test_unsupported_syntax_counts_as_a_missing_metric(self):
        self.assertIn("x", [selector.metric for selector in selectors("a * on (x) b")])


if __name__ == "__main__":
    unittest.main()
