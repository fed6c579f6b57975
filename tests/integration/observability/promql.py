"""Finds the series and labels of a PromQL expression, in the subset of the language that dashboard and alerts use.

Unsupported keywords (without, on, ignoring) count as metrics that do not exist, so that the tests fail on them.
"""
import dataclasses
import re
from typing import Dict, FrozenSet, List, Optional, Tuple

TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|\[[^\]]*\]|[A-Za-z_:][\w:]*|\d[\w.]*|=~|!~|!=|\S')
AGGREGATIONS = {"sum", "max", "min"}
OPERATORS = {"and", "or", "unless", "bool", "offset"}


@dataclasses.dataclass
class Selector:
    """One series selector of an expression."""
    metric: str
    matchers: Dict[str, Tuple[str, str]]  # label -> (operator, value)
    function: Optional[str]               # the function applied to it: "rate"; None: none
    kept: Optional[FrozenSet[str]] = None  # labels that the surrounding aggregation keeps; None: all


def selectors(expression: str) -> List[Selector]:
    """Yields the selectors in the order of the text."""
    return _Reader(TOKEN.findall(expression)).read()


class _Reader:
    def __init__(self, tokens):
        self._tokens = tokens
        self._at = 0
        self._found = []

    def read(self):
        calls = []                   # around the selector: (function, labels it keeps)
        function, kept = None, None  # of the next parenthesis
        while (token := self._next()) is not None:
            if token == "(":
                calls.append((function, kept if kept is not None or function not in AGGREGATIONS else frozenset()))
                function, kept = None, None
            elif token == ")":
                calls.pop()
            elif token == "by":
                kept = frozenset(self._list())
            elif self._is_name(token) and token not in OPERATORS:
                if self._peek() in ("(", "by"):
                    function = token
                else:
                    self._found.append(self._selector(token, calls))
        return self._found

    def _selector(self, metric, calls):
        matchers = self._matchers() if self._peek() == "{" else {}
        if is_range := (self._peek() or "").startswith("["):
            self._next()
        function = calls[-1][0] if calls and is_range else None
        kept = next((labels for _, labels in reversed(calls) if labels is not None), None)
        return Selector(metric, matchers, function, kept)

    def _matchers(self):
        matchers = {}
        self._next()
        while (label := self._next()) != "}":
            if label != ",":
                matchers[label] = (self._next(), self._next().strip('"'))
        return matchers

    def _list(self):
        self._next()
        while (label := self._next()) != ")":
            if label != ",":
                yield label

    def _next(self):
        token = self._peek()
        self._at += 1
        return token

    def _peek(self):
        return self._tokens[self._at] if self._at < len(self._tokens) else None

    @staticmethod
    def _is_name(token):
        return token[0].isalpha() or token[0] in "_:"
